// How much light a medium emits, and how the language says it.
#pragma once

#include "media/medium_optics.h"
#include "spectrum/curve.h"

#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

// How much light a medium emits for what is in it. Per unit of an amount: a spectrum of its own, or Kirchhoff's law,
// absorption coefficient times Planck's law. The curves must outlive it. Immutable, thread-safe.
class Glow {
  public:
    // W·m⁻³·sr⁻¹·nm⁻¹ at amount 1.
    static Glow ofSpectrum(const Curve& emission) { return {&emission, nullptr, nullptr}; }
    // 1/m at amount 1.
    static Glow ofTemperature(const Curve& absorption) { return {nullptr, &absorption, nullptr}; }
    // Absorbing what is not scattered.
    static Glow ofTemperature(const Curve& extinction, const Curve& albedo) { return {nullptr, &extinction, &albedo}; }

    bool thermal() const { return spectrum_ == nullptr; }
    // Of what scatters nothing.
    Glow withoutAlbedo() const { return {spectrum_, extinction_, nullptr}; }
    // True where the share that is scattered matters, which may vary in space.
    bool byAlbedo() const { return albedo_ != nullptr; }
    // W·m⁻³·sr⁻¹·nm⁻¹; `kelvin` is looked at when thermal(), `tint` is a factor of the albedo.
    Spectrum at(float kelvin, const Wavelengths&) const noexcept;
    Spectrum at(float kelvin, const Wavelengths&, const Spectrum& tint) const noexcept;

    // Its integrals over wavelength, without tint. `seen` weighs it as the eye and cameras do, on any scale.
    struct Totals {
        double watts = 0; // W·m⁻³·sr⁻¹
        double seen = 0;
    };
    Totals totals(double kelvin) const;

  private:
    Glow(const Curve* spectrum, const Curve* extinction, const Curve* albedo)
        : spectrum_(spectrum), extinction_(extinction), albedo_(albedo) {}
    const Curve *spectrum_, *extinction_, *albedo_;
};

// Glow::totals() for quick lookups. Increases with temperature.
class GlowTable {
  public:
    // For temperatures up to `hottest`.
    GlowTable(const Glow&, double hottest);
    float seen(float kelvin) const noexcept { return lookup(seen_, kelvin); }
    float watts(float kelvin) const noexcept { return lookup(watts_, kelvin); }

  private:
    float lookup(const std::vector<float>&, float kelvin) const noexcept;
    std::vector<float> seen_, watts_; // one entry: the temperature does not matter
    float perKelvin_ = 0;
};

// What a medium emits, as a scene states it.
struct GlowParams {
    const Curve* emission = nullptr;   // W·m⁻³·sr⁻¹·nm⁻¹ at amount 1
    const Curve* emissivity = nullptr; // 1/m at amount 1
};

// What cannot be: emitting twice, by what is not absorbed, by nothing; or an empty text. `color`: albedo varies in
// space.
std::string_view findContradiction(const GlowParams&, const MediumOptics&, bool temperature, bool color = false);
// Nothing for media that do not emit. Requires no contradiction.
std::optional<Glow> makeGlow(const GlowParams&, const MediumOptics&, bool temperature);

template <typename P> void addGlowFields(std::vector<schema::FieldInfo>& fields) {
    using namespace schema;
    fields.push_back(field<P, const Curve*>(FieldType::spectrum, "emission", &P::emission)
                         .role(SpectrumRole::emission)
                         .range(0, 1e12)
                         .synonyms({"Le", "emission_color", "glow"})
                         .doc("What it gives off by itself where its amount is 1, in W per m³, sr and nm: radiance per "
                              "metre of the way.")
                         .example("emission rgb 0.2 0.5 1"));
    fields.push_back(field<P, const Curve*>(FieldType::spectrum, "emissivity", &P::emissivity)
                         .role(SpectrumRole::unbounded)
                         .unit({Dimension::inverseLength, Dimension::none})
                         .range(0, 1e12)
                         .synonyms({"emission_strength", "blackbody_intensity"})
                         .doc("With `temperature`: share of a black body's light that a metre gives off where the "
                              "amount is 1. When absent, what the medium absorbs.")
                         .example("emissivity 2 per-m"));
}

} // namespace abbe

// How the language says what a medium gives off.
#pragma once

#include "media/glow.h"
#include "media/medium_optics.h"

#include <string_view>

namespace abbe {

struct GlowParams {
    const Curve* emission = nullptr;   // W·m⁻³·sr⁻¹·nm⁻¹ at amount 1
    const Curve* emissivity = nullptr; // 1/m at amount 1
};

// What cannot be: shining twice, by what is not absorbed, by nothing; or an empty text. `color`: albedo varies in
// space.
std::string_view findContradiction(const GlowParams&, const MediumOptics&, bool temperature, bool color = false);
// Nothing for media that do not shine. Requires no contradiction.
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

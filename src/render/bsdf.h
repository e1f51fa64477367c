// Scattering at one point. Directions are local: +z is the shading normal, wo points towards the eye, wi is the new
// direction. Both are unit vectors.
#pragma once

#include "base/flags.h"
#include "math/vec.h"
#include "render/effects.h"
#include "render/receiver.h"
#include "spectrum/spectrum.h"

#include <cstdint>
#include <optional>
#include <type_traits>

namespace abbe {

// The ratio of densities in a build in which none depends on wavelength. Stands for a Spectrum that is 1 and takes no
// room and no time.
struct UnitRatio {
    UnitRatio() = default;
    UnitRatio(Spectrum) {}
    operator Spectrum() const { return Spectrum(1.f); }
    UnitRatio operator*(float) const { return {}; }
};

enum class Lobe : std::uint8_t {
    diffuse = 1,
    glossy = 2,
    delta = 4,
    reflection = 8,
    transmission = 16,
    dispersive = 32, // direction or density depends on wavelength
};
using Lobes = Flags<Lobe>;

// Which way the path runs: radiance from the eye, importance from a light. Refraction scales radiance by 1/η². That is
// all that the way changes here: where f is not reciprocal, light paths need f with its directions exchanged, which
// is LightVertex's business (render/light_vertex.h).
enum class Transport : std::uint8_t { radiance, importance };

// Densities at each lane's wavelength over the hero's.
using DensityRatio = std::conditional_t<isCompiled(Effect::dispersion), Spectrum, UnitRatio>;

// Value and density of a pair of directions; delta lobes are left out of both.
struct BsdfEval {
    Spectrum fcos; // f(wo, wi) |cos θi|, 1/sr
    float pdfSolidAngle = 0;
    [[no_unique_address]] DensityRatio pdfRatio{Spectrum(1.f)}; // 1 unless lobes() has dispersive
};

struct BsdfSample {
    // All at once: see Bsdf::sample.
    BsdfSample(Vec3 direction, const Spectrum& w, float pdf, Lobes l, float indexRatio = 1,
               const DensityRatio& ratios = Spectrum(1.f))
        : wi(direction), weight(w), pdfSolidAngle(pdf), lobe(l), eta(indexRatio), pdfRatio(ratios) {}

    Vec3 wi;
    Spectrum weight;     // fcos / density at the hero's wavelength (delta lobes: the ratio of the deltas)
    float pdfSolidAngle; // hero's; 0 is not returned. Delta lobes: probability of the lobe
    Lobes lobe;
    float eta; // index ratio (transmitted side over incident side) crossed by a transmission; 1 otherwise
    // As in BsdfEval. A *delta* transmission with Lobe::dispersive instead means that the other wavelengths would have
    // gone elsewhere: the integrator ends them (docs/architecture.md, "Dispersion").
    [[no_unique_address]] DensityRatio pdfRatio;
};

// What delta lobes scatter from wi to wo.
struct DeltaEval {
    Spectrum ratio{0.f};   // of the deltas, for Transport::radiance: weight times probability of sample() from wo
    float probability = 0; // that sample() from wo goes to wi

    DeltaEval& operator+=(const DeltaEval& b) {
        ratio += b.ratio;
        probability += b.probability;
        return *this;
    }
};

// Lives in an Arena: trivially destructible, no longer than the vertex. Random choices between lobes that depend on
// spectral values use the mean over the lanes, so that they are the same for all rotations of the hero [Wilkie2014].
class Bsdf {
  public:
    // Without Lobe::transmission all of eval() is 0 where wo.z wi.z <= 0: lights behind are then not looked for.
    virtual Lobes lobes() const noexcept = 0;
    virtual BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept = 0;
    // uLobe, u in [0, 1). Nothing: the path ends here (no direction, zero weight). Implementations make the sample in
    // place, `return std::optional<BsdfSample>(std::in_place, …)`: one that is filled field by field and then copied is
    // read back in wider pieces than it was written, which stalls the processor (measured: 15 ns a vertex).
    virtual std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept = 0;
    // The delta lobes between two directions, one of which a delta sample has led to from the other, up to rounding;
    // nothing for other pairs. All of them together where several lead the same way.
    virtual DeltaEval evalDelta([[maybe_unused]] Vec3 wo, [[maybe_unused]] Vec3 wi) const noexcept { return {}; }
    // How it scatters light towards wo. Asked for only with Lobe::glossy; delta lobes are left out.
    virtual ScatterOutline outline([[maybe_unused]] Vec3 wo) const noexcept { return {}; }

  protected:
    ~Bsdf() = default; // never deleted through the base
};

} // namespace abbe

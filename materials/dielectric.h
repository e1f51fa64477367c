// Glass, water, plastic films: reflects and refracts at a smooth or rough interface; the inside may absorb.
#pragma once

#include "materials/ggx.h"
#include "render/bsdf.h"
#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

// Outside is the side that the normal points to; the index there is 1.
struct DielectricParams {
    const Curve* ior = nullptr;              // index of the inside; null: 1.5. A curve that varies disperses
    schema::TexturedNumber roughness = {};   // 0 … 1; α = roughness²
    const Curve* absorption = nullptr;       // 1/m, inside; null: clear
    const Curve* attenuationColor = nullptr; // share left after attenuationDistance; instead of absorption
    double attenuationDistance = 1;          // m
};

schema::TypeInfo dielectricType();
// The curves must outlive the material.
std::unique_ptr<const Material> makeDielectric(const DielectricParams&);

// Scattering at the interface of a dielectric. n: refractive index of the inside (-z) at each lane; outside it is 1.
//
// Wavelengths: whether to reflect is decided with the mean reflectance over the lanes, the same for all rotations of
// the hero [Wilkie2014]. The reflected direction does not depend on wavelength, so reflection keeps all lanes. So does
// refraction if the index is the same in all lanes. Otherwise the hero's refracted direction is taken: a polished
// interface says so with Lobe::dispersive and the integrator ends the other lanes; a rough one, where other lanes could
// have gone the same way off another microfacet, states the density of each.

// True if the index differs between the lanes by more than rounding.
inline bool disperses(Spectrum n) { return maxLane(abs(n - Spectrum(n[0]))) >= 1e-5f; }

// Radiance is compressed into a smaller cone by refraction: 1/η² towards the eye, nothing for light paths.
inline Spectrum compression(Spectrum eta, Transport transport) {
    return transport == Transport::radiance ? Spectrum(1.f) / (eta * eta) : Spectrum(1.f);
}

class SmoothDielectricBsdf final : public Bsdf {
  public:
    explicit SmoothDielectricBsdf(Spectrum n)
        : n_(n), disperses_(disperses(n)), absent_(maxLane(abs(n - Spectrum(1.f))) < 1e-6f) {}

    Lobes lobes() const noexcept override;
    BsdfEval eval(Vec3, Vec3, Transport) const noexcept override { return {}; }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override;
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override;

  private:
    std::optional<BsdfSample> transmit(Vec3 wo, Spectrum eta, Spectrum share, float probability, Transport) const;
    Spectrum n_;
    bool disperses_;
    bool absent_; // index 1 to within rounding: rays pass straight on
};

// Walter et al.'s rough interface [Walter2007] with GGX; reflection and transmission are scaled so that they have what
// they have after any number of events between microfacets, which is all of the light.
class RoughDielectricBsdf final : public Bsdf {
  public:
    // False if the surface is smooth, or refracts so little that the transmitted lobe is narrower than directions in
    // single precision can tell (α |n - 1| < 5e-5, a tenth of Ggx::kSmooth): use the polished interface instead.
    static bool representable(Spectrum n, Ggx ggx) {
        const float weakest = -maxLane(-abs(n - Spectrum(1.f)));
        return !ggx.smooth() && ggx.alphaX() * weakest >= 5e-5f;
    }
    // Requires representable(n, ggx) and an isotropic ggx.
    RoughDielectricBsdf(Spectrum n, Ggx ggx) : n_(n), ggx_(ggx), disperses_(disperses(n)) {}

    Lobes lobes() const noexcept override;
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override;
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override;
    ScatterOutline outline(Vec3 wo) const noexcept override;

  private:
    // Below, wo.z > 0 and eta is the index of the far side over that of wo's side.
    struct LaneEval {
        Spectrum fcos, pdf;
    };
    // Factors of both parts, and what they make of a microfacet hit at cosine c.
    struct Scale {
        Spectrum reflection, transmission;
    };
    struct Facet {
        Spectrum reflected, transmitted;
        float probability; // of reflection
    };
    Scale lossless(float mu, Spectrum eta) const;
    static Facet facet(const Scale&, float c, Spectrum eta);

    BsdfEval evalReflection(Vec3 wo, Vec3 wi, Spectrum eta) const;
    LaneEval transmission(Vec3 wo, Vec3 wi, Spectrum eta, Transport) const;
    std::optional<BsdfSample> sampleTransmission(Vec3 wo, Vec3 m, Spectrum eta, const Facet&, Transport) const;

    Spectrum n_;
    Ggx ggx_;
    bool disperses_;
};

} // namespace abbe

// Hair and fur: what curves are made of.
#pragma once

#include "render/bsdf.h"
#include "render/material.h"
#include "schema/type.h"

#include <array>
#include <memory>

namespace abbe {

// Light on one fibre of hair, as seen from near by: the point where it enters is known.

// The density of the sine of the inclination about a cone, per solid angle over 2π: cosθi dθi integrates to 1
// [dEon2011, eq. 7]. Sines and cosines of θi and θo; the cone is θi = -θo. v > 0 is the variance for narrow lobes.
float hairLongitudinal(float sinI, float cosI, float sinO, float cosO, float v);

// Variance of the inclination of light reflected off the fibre for a roughness βm, and width of the azimuth's logistic
// distribution for βn, both in [0, 1] [Chiang2016, eq. 7 and 8]. At least 1e-4 and 1e-3: single precision has no digits
// for less.
float hairVariance(float longitudinalRoughness);
float hairAzimuthalWidth(float azimuthalRoughness);

// A clear, absorbing cylinder of dielectric with tilted scales [Chiang2016]: light is reflected (p = 0), passes (1),
// is reflected inside once (2) and, all together, more often. Locally +x runs along the fibre from root to tip and +z
// is the normal where the ray hit it. Light arrives from all around and leaves all around. Lossless without absorption.
// Not reciprocal: h belongs to wo.
class HairBsdf final : public Bsdf {
  public:
    struct Fibre {
        float h = 0;        // where across the fibre wo hits it, -1 … 1: minus its share of the radius along
                            // x × wo
        float eta = 1.55f;  // index of the inside
        float variance = 0; // hairVariance()
        float width = 0;    // hairAzimuthalWidth()
        float sinScale = 0, cosScale = 1; // of the tilt of the scales
        Spectrum absorption;              // coefficient times radius
    };

    explicit HairBsdf(const Fibre&);

    Lobes lobes() const noexcept override { return Lobes(Lobe::glossy) | Lobe::reflection | Lobe::transmission; }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override;
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override;

    static constexpr int kOrders = 4; // 0, 1, 2, and all further ones

  private:
    struct Order {
        Spectrum share;   // of the light, A_p
        float chance;     // of being sampled
        float sinO, cosO; // wo turned about by the scales
        float variance;
        float azimuth; // where the light leaves, against wo's azimuth; not for the last one, which leaves evenly
    };
    std::array<Order, kOrders> orders(Vec3 wo) const;
    BsdfEval evalOrders(const std::array<Order, kOrders>&, Vec3 wo, Vec3 wi) const;

    Fibre fibre_;
    float gammaO_;
};

struct HairParams {
    schema::TexturedNumber eumelanin, pheomelanin; // concentrations [dEon2011]; 0: none
    const Curve* absorption = nullptr;             // of a dye, coefficient times radius of the fibre; null: none
    schema::TexturedSpectrum color;                // of many fibres, in place of absorption
    double ior = 1.55;
    schema::TexturedNumber longitudinalRoughness{0.3, nullptr, {}}, azimuthalRoughness{0.3, nullptr, {}};
    double scaleAngle = 0.034906585; // rad; 2°
};

schema::TypeInfo hairType();
// Curves and textures must outlive the material.
std::unique_ptr<const Material> makeHair(const HairParams&);

// Absorption of melanin at unit concentration, times the radius of a fibre: the powers of the wavelength of
// [Donner2006, sec. 3] through the values of [dEon2011] for green.
Spectrum eumelaninAbsorption(const Wavelengths&);
Spectrum pheomelaninAbsorption(const Wavelengths&);

} // namespace abbe

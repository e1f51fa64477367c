// Hair and fur: what curves are made of.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

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

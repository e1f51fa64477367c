// Glass, water, plastic films: reflects and refracts at a smooth or rough interface; the inside may absorb.
#pragma once

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

} // namespace abbe

// Metals: reflection from a smooth or rough surface with a complex refractive index.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct ConductorParams {
    schema::ComplexIndex index;             // both curves set
    schema::TexturedNumber roughness = {};  // 0 … 1; α = roughness²
    schema::TexturedNumber anisotropy = {}; // 0 … 1; αy = (1 - anisotropy) αx
    schema::TexturedSpectrum tint = {};     // 0 … 1, factor on all that is reflected; absent: 1
};

schema::TypeInfo conductorType();
// Requires index.n and index.k, which must outlive the material.
std::unique_ptr<const Material> makeConductor(const ConductorParams&);

} // namespace abbe

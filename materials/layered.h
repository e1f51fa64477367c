// A clear coat over another material: varnish, lacquer, a wet film.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct LayeredParams {
    schema::Reference base;            // material
    const Curve* ior = nullptr;        // of the coat, set; its value at 587.6 nm counts
    float roughness = 0;               // of the coat
    const Curve* tint = nullptr;       // share left after the way in and out, straight; null: all
    const Curve* absorption = nullptr; // 1/m; with thickness, in place of tint
    double thickness = 1e-4;           // m
    double darkening = 1;              // 0 … 1
};

schema::TypeInfo layeredType();
// Refers to the base, which must outlive it, as must the curves. Requires that the base has no inside, is no boundary
// and does not shine.
std::unique_ptr<const Material> makeLayered(const LayeredParams&, const Material& base);

} // namespace abbe

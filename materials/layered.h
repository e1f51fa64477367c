// A clear coat over another material: varnish, lacquer, a wet film.
#pragma once

#include "render/kept_tables.h"
#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct LayeredParams {
    schema::Reference base;                                // material
    const Curve* ior = nullptr;                            // of the coat, set; its value at 587.6 nm counts
    schema::TexturedNumber roughness;                      // of the coat
    schema::TexturedSpectrum tint;                         // share left after the way in and out, straight; absent: all
    const Curve* absorption = nullptr;                     // 1/m; with thickness, in place of tint
    double thickness = 1e-4;                               // m
    schema::TexturedNumber thicknessScale{1, nullptr, {}}; // factor on what the coat absorbs
    schema::TexturedNumber darkening{1, nullptr, {}};      // 0 … 1
};

schema::TypeInfo layeredType();
// Refers to the base, which must outlive it, as must curves and textures. Requires that the base has no inside, is no
// boundary and does not emit. `kept`: tables of the coat.
std::unique_ptr<const Material> makeLayered(const LayeredParams&, const Material& base, KeptTables* kept = nullptr);

} // namespace abbe

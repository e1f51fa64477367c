// Skin, marble, wax, milk: light that wanders under the surface and comes out elsewhere.
#pragma once

#include "materials/interior_curves.h"
#include "render/kept_tables.h"
#include "render/material.h"
#include "schema/type.h"

#include <memory>
#include <optional>

namespace abbe {

struct SubsurfaceParams {
    const Curve* reflectance = nullptr;  // 0 … 1; set
    const Curve* meanFreePath = nullptr; // m; set
    double anisotropy = 0;
    const Curve* ior = nullptr; // set
    schema::TexturedNumber roughness{0.3, nullptr, {}};
    schema::Choice boundary{"dielectric", {}};
};

schema::TypeInfo subsurfaceType();
// The surface alone, and what is inside. Curves and textures must outlive either. `kept`: tables of the gloss.
std::unique_ptr<const Material> makeSubsurfaceSurface(const SubsurfaceParams&, KeptTables* kept = nullptr);
std::optional<SubsurfaceInside> insideOf(const SubsurfaceParams&);

} // namespace abbe

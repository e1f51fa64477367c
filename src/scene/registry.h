// The only list of types: every material, light, shape, camera, film and render type that a scene can name.
#pragma once

#include "cameras/camera_params.h"
#include "materials/subsurface_albedo.h"
#include "render/material.h"
#include "render/texture.h"
#include "scene/material_dress.h"
#include "scene/material_parts.h"
#include "schema/type.h"
#include "textures/texture_store.h"

#include <functional>
#include <memory>
#include <string_view>

namespace abbe {

// All field tables, in the order of the manual.
schema::TypeTable makeTypeTable();

// Fills the parameter struct of a type; false after an error.
using BindParams = std::function<bool(void* params)>;

// A material before it is dressed; null after an error.
struct MadeMaterial {
    std::unique_ptr<const Material> material;
    MaterialDress dress;
    std::optional<SubsurfaceInside> inside; // of translucent solids: a medium to be made of it
};

// A material of a registered type from bound parameters. Requires a name out of the table.
MadeMaterial makeMaterial(std::string_view type, const BindParams&, const MaterialParts&);

// A texture of a registered type from bound parameters, or null after an error. Requires a name out of the table.
std::unique_ptr<Texture> makeTexture(std::string_view type, const BindParams&, const std::shared_ptr<TextureStore>&,
                                     Diagnostics&);

// A camera of a registered type from bound parameters, or nothing after an error. Requires a name out of the table.
std::optional<PlacedCamera> makeCamera(std::string_view type, const BindParams&, const CameraContext&, Diagnostics&);

// The material of shapes that name none, and of lamps.
std::unique_ptr<const Material> makePlainMaterial(const Curve* reflectance);

} // namespace abbe

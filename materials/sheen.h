// Cloth and dust: a layer of fuzz on a matte ground.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct SheenParams {
    schema::TexturedSpectrum color;     // of the fuzz, 0 … 1; absent: 1
    schema::TexturedSpectrum baseColor; // reflectance of the ground, 0 … 1; absent: 0.2
    schema::TexturedNumber roughness{0.3, nullptr, {}};
};

schema::TypeInfo sheenType();
// Curves and textures must outlive the material.
std::unique_ptr<const Material> makeSheen(const SheenParams&);

} // namespace abbe

// Lambert's ideal diffuse reflection, on both sides.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct DiffuseParams {
    schema::TexturedSpectrum reflectance = {}; // 0 … 1; absent: 0.5
};

schema::TypeInfo diffuseType();
// What it refers to must outlive the material.
std::unique_ptr<const Material> makeDiffuse(const DiffuseParams&);

} // namespace abbe

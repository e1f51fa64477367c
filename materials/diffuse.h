// Lambert's ideal diffuse reflection, on both sides.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct DiffuseParams {
    const Curve* reflectance = nullptr; // 0 … 1; null: 0.5
};

schema::TypeInfo diffuseType();
// The curve must outlive the material.
std::unique_ptr<const Material> makeDiffuse(const DiffuseParams&);

} // namespace abbe

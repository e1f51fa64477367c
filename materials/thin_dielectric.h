// A clear sheet with two parallel faces: a window pane, a plastic wrapper.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct ThinDielectricParams {
    const Curve* ior = nullptr;    // null: 1.5
    schema::TexturedSpectrum tint; // share that one straight pass leaves, 0 … 1; absent: 1
};

schema::TypeInfo thinDielectricType();
// Curves and textures must outlive the material.
std::unique_ptr<const Material> makeThinDielectric(const ThinDielectricParams&);

} // namespace abbe

// No surface at all: where a medium ends.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct BoundaryParams {};

schema::TypeInfo boundaryType();
std::unique_ptr<const Material> makeBoundary(const BoundaryParams&);

} // namespace abbe

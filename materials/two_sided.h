// A sheet whose sides differ: a playing card, a coated film.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct TwoSidedParams {
    schema::Reference front, back; // materials
};

schema::TypeInfo twoSidedType();
// Refers to both, which must outlive it. Requires that neither has an inside (hasInside), is a boundary or emits. To
// the back's material the back is the outside.
std::unique_ptr<const Material> makeTwoSided(const Material& front, const Material& back);

} // namespace abbe

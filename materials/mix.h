// A mixture of two materials: rust on steel, dust on glass, by a share that may vary over the surface.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct MixParams {
    schema::Reference first, second;                 // materials
    schema::TexturedNumber amount{0.5, nullptr, {}}; // share of the second one, 0 … 1
};

schema::TypeInfo mixMaterialType();
// Refers to both, which must outlive it. Requires that at most one of them has an inside, or that their insides are the
// same (sameInside), and that neither is a boundary or shines.
std::unique_ptr<const Material> makeMix(const MixParams&, const Material& first, const Material& second);

// Whether light may enter closed shapes of the material.
bool hasInside(const Material&);
// Whether two materials fill shapes with the same: index, absorption and medium.
bool sameInside(const Material&, const Material&);

} // namespace abbe

// What materials that consist of others are made from.
#pragma once

#include "base/diagnostic.h"
#include "materials/layered.h"
#include "materials/mix.h"
#include "materials/two_sided.h"
#include "schema/scene_tree.h"

#include <memory>
#include <vector>

namespace abbe {

// The materials of a scene so far, for one definition that refers to some of them.
struct MaterialParts {
    const std::vector<std::unique_ptr<const Material>>& made;
    const schema::Definition& definition;
    Diagnostics& diagnostics;

    const Material& operator[](schema::Reference reference) const { return *made[reference.index]; }
};

// From bound parameters, whose references are valid; null after an error.
std::unique_ptr<const Material> makeMixOf(const MixParams&, const MaterialParts&);
std::unique_ptr<const Material> makeLayeredOf(const LayeredParams&, const MaterialParts&);
std::unique_ptr<const Material> makeTwoSidedOf(const TwoSidedParams&, const MaterialParts&);

// Where a definition states a property, or the definition itself.
Span placeOf(const schema::Definition&, std::string_view property);

} // namespace abbe

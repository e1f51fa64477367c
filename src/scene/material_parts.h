// Materials that consist of others.
#pragma once

#include "materials/layered.h"
#include "materials/mix.h"
#include "materials/openpbr.h"
#include "materials/two_sided.h"
#include "scene/material_builder.h"

#include <memory>

namespace abbe {

// From bound parameters, whose references are valid; null after an error.
std::unique_ptr<const Material> makeMixOf(const MixParams&, const MaterialContext&);
std::unique_ptr<const Material> makeLayeredOf(const LayeredParams&, const MaterialContext&);
std::unique_ptr<const Material> makeTwoSidedOf(const TwoSidedParams&, const MaterialContext&);

// Takes out of a material what the command leaves out.
void leaveOutEffects(OpenPbrParams&, const MaterialContext&);

// Where a definition states a property, or the definition itself.
Span placeOf(const schema::Definition&, std::string_view property);

} // namespace abbe

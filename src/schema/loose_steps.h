// Steps of a transform that stand outside of its block: `rotate y 45 deg` as a property.
#pragma once

#include "schema/entry.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

// translate, rotate, scale, matrix, look-at
std::span<const std::string_view> transformSteps();
bool isTransformStep(std::string_view word);

// One error for all such steps of `owner` ("`shape sphere`"), which are not empty, with the block that holds them.
// `given`: there is a transform already.
void reportLooseSteps(std::string_view owner, const std::vector<Node>& steps, bool given, Diagnostics&);

} // namespace abbe::schema

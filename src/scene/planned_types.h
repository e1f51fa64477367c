// Types that the language knows and this version does not render: their properties are checked like any other's, so
// that a scene written for a later version gets its mistakes explained, and then a plain word on what is missing.
#pragma once

#include "schema/type.h"

#include <functional>
#include <string_view>
#include <vector>

namespace abbe {

std::vector<schema::TypeInfo> plannedTypes();
bool isPlanned(schema::Kind, std::string_view type);
// Calls `bind` with parameters of the type, which are then forgotten. Requires isPlanned(kind, type).
void bindPlanned(schema::Kind, const std::function<void(void* params)>& bind);

} // namespace abbe

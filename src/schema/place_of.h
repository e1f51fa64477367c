// Where the properties of one definition stand.
#pragma once

#include "base/source.h"

#include <functional>
#include <string_view>

namespace abbe::schema {

// Where a definition states a property, or the definition itself where it leaves the property out.
using PlaceOf = std::function<Span(std::string_view property)>;

} // namespace abbe::schema

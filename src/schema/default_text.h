// Default values are written in the field tables as a scene would write them; they are bound like any property.
#pragma once

#include "schema/document.h"

#include <memory>
#include <string_view>

namespace abbe::schema {

// A document with the single property `name text`, for texts of numbers, units, words and quoted words without spaces.
// Its spans are invalid.
std::unique_ptr<Document> documentOf(std::string_view name, std::string_view text);

} // namespace abbe::schema

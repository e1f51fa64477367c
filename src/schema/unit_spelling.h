// One spelling for each unit: what `abbe fmt` writes.
#pragma once

#include "schema/document.h"

#include <string>
#include <string_view>

namespace abbe::schema {

// The spelling of a unit that is offered first for its dimension and scale: "nits" for "cd-per-m2", "um" for "µm",
// "stops" for "EV". Empty for what is no unit.
std::string_view canonicalUnit(std::string_view unit);

// The text of a document, its units behind numbers in that spelling; nothing else changes, no number in particular. A
// word that some definition has for a name is left as it is, as it may be meant.
std::string withCanonicalUnits(std::string_view text, const Document&);

} // namespace abbe::schema

// The order in which diagnostics are shown.
#pragma once

#include "base/diagnostic.h"

#include <vector>

namespace abbe {

// By file and position; those without a place come first. Equal places keep the order in which they were found.
std::vector<const Diagnostic*> sortedByPlace(const Diagnostics&);

} // namespace abbe

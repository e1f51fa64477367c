// Applying the mechanical repairs of diagnostics to a text: `abbe check --fix`.
#pragma once

#include "base/diagnostic.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace abbe {

struct FixResult {
    std::string text;
    std::size_t applied = 0; // diagnostics that were repaired
};

// Applies the fixes that lie in `file`, whose text is `text`. The fixes of one diagnostic are applied together or not
// at all; where two diagnostics want to change the same place, the first one wins and the other is left for the next
// run.
FixResult applyFixes(std::string_view text, FileId file, const Diagnostics&);

} // namespace abbe

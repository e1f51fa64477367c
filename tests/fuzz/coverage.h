// Which edges an input took, where the code under test was compiled with -fsanitize-coverage=trace-pc (preset `fuzz`);
// elsewhere nothing is ever new, and inputs are changed blindly.
#pragma once

namespace abbe::fuzz {

void beginCoverage();
// Whether something was met, or was met many times more often, for the first time since the program began.
bool foundNew();

} // namespace abbe::fuzz

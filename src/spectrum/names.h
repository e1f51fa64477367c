// Comparison of the names of library data.
#pragma once

#include <string_view>

namespace abbe {

// Equal but for the case of ASCII letters.
bool sameName(std::string_view a, std::string_view b);

} // namespace abbe

// Words as a shell takes them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// The argument as a shell would need it.
std::string shellQuoted(std::string_view argument);
// The arguments of a line of them.
std::vector<std::string> shellWords(std::string_view line);

} // namespace abbe

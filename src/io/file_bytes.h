// A whole file in memory.
#pragma once

#include <string>

namespace abbe {

// Throws IoError.
std::string readFileBytes(const std::string& path);

} // namespace abbe

// A whole file in memory.
#pragma once

#include <string>

namespace abbe {

// Of a regular file. Throws IoError, and BeyondMemory before it reads more than may be taken.
std::string readFileBytes(const std::string& path);

} // namespace abbe

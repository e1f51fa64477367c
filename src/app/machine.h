// Facts about the machine and this process.
#pragma once

#include <cstdint>
#include <string>

namespace abbe {

std::string processorName(); // as the system tells it; empty if it does not
std::uint64_t peakMemory();  // bytes of this process so far

} // namespace abbe

// Facts about the machine and this process.
#pragma once

#include <cstdint>

namespace abbe {

double physicalMemory();    // bytes
std::uint64_t peakMemory(); // bytes of this process so far

} // namespace abbe

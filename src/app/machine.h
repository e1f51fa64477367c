// Facts about the machine and this process.
#pragma once

#include <cstdint>
#include <string>

namespace abbe {

std::string processorName();    // as the system tells it; empty if it does not
double physicalMemory();        // bytes
double availableMemory();       // the same, or the limit of the control group that this process is in
std::uint64_t peakMemory();     // bytes of this process so far
std::uint64_t residentMemory(); // bytes of it now; 0 if the system does not tell

} // namespace abbe

// The parallel loop of the program (TBB underneath, hidden here because its headers are slow to compile), and how work
// that may take long hears that it is to end.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace abbe {

// Limits all loops of the process to `threads` workers (0: one per core). Call once, before the first loop.
void setThreadCount(int threads);
int threadCount();

// Calls body(i) for every i in [0, count), in any order, from many threads. Each worker has flush-to-zero and
// denormals-are-zero set (Embree asks for it, and denormals cost a hundredfold). Exceptions propagate to the caller.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

// Sets flush-to-zero and denormals-are-zero in the calling thread.
void flushDenormals();

// Set once, by anyone, and never reset while somebody looks at it. Looking costs a load.
using StopFlag = std::atomic<bool>;
// For work that nobody ends.
inline const StopFlag kNeverStop{false};

} // namespace abbe

// The parallel loop of the program (TBB underneath, hidden here because its headers are slow to compile), and how work
// that may take long hears that it is to end.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace abbe {

// All loops of the process are run by so many workers (0: one per core), be there as many cores or not, up to 32 for
// each core. Call once, before the first loop.
void setThreadCount(int threads);
int threadCount();

// Calls body(i) for every i in [0, count), in any order, from many threads. Each worker has flush-to-zero and
// denormals-are-zero set (Embree asks for it, and denormals cost a hundredfold). Exceptions propagate to the caller.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

// The same from within the body of another loop, whose caller may hold locks: workers that have nothing to do take
// part, and while the caller waits for them it does no other work than this loop's.
void parallelParts(std::size_t count, const std::function<void(std::size_t)>& body);

// Sets flush-to-zero and denormals-are-zero in the calling thread.
void flushDenormals();

// Set once, by anyone, and never reset while somebody looks at it. Looking costs a load.
using StopFlag = std::atomic<bool>;
// For work that nobody ends.
inline const StopFlag kNeverStop{false};

} // namespace abbe

// How work that may take long hears that it is to end.
#pragma once

#include <atomic>

namespace abbe {

// Set once, by anyone, and never reset while somebody looks at it. Looking costs a load.
using StopFlag = std::atomic<bool>;
// For work that nobody ends.
inline const StopFlag kNeverStop{false};

} // namespace abbe

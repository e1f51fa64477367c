// When a render is to end, for those who are in the middle of a pixel, a path or a pilot.
#pragma once

#include "base/parallel.h"

#include <condition_variable>
#include <mutex>
#include <thread>

namespace abbe {

// Looks at the clock and at whoever may end the render from a thread of its own, so that everyone else looks at one
// flag. If the system has no thread for it the flag stays down, and a render ends between portions alone.
class EndWatch {
  public:
    // `asked`: set by whoever wants the render to end; null: nobody will. `seconds`: from now on; 0: without an end.
    EndWatch(const StopFlag* asked, double seconds);
    ~EndWatch();
    EndWatch(const EndWatch&) = delete;
    EndWatch& operator=(const EndWatch&) = delete;

    // Set a few milliseconds after the time is over, or after `asked` was.
    const StopFlag& over() const { return over_; }

  private:
    void run(const StopFlag* asked, double seconds);

    StopFlag over_{false};
    std::mutex mutex_;
    std::condition_variable changed_;
    bool gone_ = false;
    std::thread thread_;
};

} // namespace abbe

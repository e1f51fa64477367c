// Work that cannot be ended once it has begun, such as reading a scene, so that Ctrl-C need not wait for it.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>

namespace abbe::python {

// Does `work`, which must not touch Python, on a thread of its own, and throws what it throws. The caller has Python's
// lock, lets go of it meanwhile, and looks for signals: what they raise is thrown within a tenth of a second. The work
// then goes on as abandoned, so it must own all that it uses.
void runInterruptibly(std::function<void()> work);

// Work that nobody waits for any more. Lives as long as the work.
class Abandoned {
  public:
    Abandoned();
    ~Abandoned();
    Abandoned(const Abandoned&) = delete;
    Abandoned& operator=(const Abandoned&) = delete;

    // Waits for the end of all of it, a twentieth of a second at most. Whether it has come.
    static bool waitForAll();
};

} // namespace abbe::python

#include "binding/background.h"

#include <chrono>
#include <nanobind/nanobind.h>
#include <optional>
#include <thread>
#include <utility>

namespace abbe::python {

namespace nb = nanobind;

namespace {

constexpr std::chrono::milliseconds kLook{50};

struct AbandonedWork {
    std::mutex mutex;
    std::condition_variable changed;
    int count = 0;
};

// Never destroyed: threads may outlive the statics.
AbandonedWork& abandonedWork() {
    static auto* const work = new AbandonedWork;
    return *work;
}

// Shared by the thread and by whoever waits for it.
struct BackgroundTask {
    std::function<void()> work;
    std::mutex mutex;
    std::condition_variable changed;
    bool done = false;
    std::exception_ptr fault;
    std::optional<Abandoned> abandoned; // while nobody waits for it

    void run() {
        std::exception_ptr thrown;
        try {
            work();
        } catch (...) {
            thrown = std::current_exception();
        }
        work = nullptr; // what it owns is gone before its end is known
        const std::scoped_lock lock(mutex);
        fault = thrown;
        done = true;
        abandoned.reset();
        changed.notify_all();
    }
    bool wait() {
        std::unique_lock lock(mutex);
        return changed.wait_for(lock, kLook, [this] { return done; });
    }
    void abandon() {
        const std::scoped_lock lock(mutex);
        if (!done) abandoned.emplace();
    }
};

} // namespace

Abandoned::Abandoned() {
    const std::scoped_lock lock(abandonedWork().mutex);
    ++abandonedWork().count;
}

Abandoned::~Abandoned() {
    const std::scoped_lock lock(abandonedWork().mutex);
    --abandonedWork().count;
    abandonedWork().changed.notify_all();
}

bool Abandoned::waitForAll() {
    std::unique_lock lock(abandonedWork().mutex);
    return abandonedWork().changed.wait_for(lock, kLook, [] { return abandonedWork().count == 0; });
}

void runInterruptibly(std::function<void()> work) {
    const auto task = std::make_shared<BackgroundTask>();
    task->work = std::move(work);
    std::thread thread([task] { task->run(); });
    for (bool done = false; !done;) {
        {
            const nb::gil_scoped_release free;
            done = task->wait();
        }
        if (!done && PyErr_CheckSignals() != 0) {
            task->abandon();
            thread.detach();
            nb::raise_python_error();
        }
    }
    {
        const nb::gil_scoped_release free;
        thread.join();
    }
    if (task->fault) std::rethrow_exception(task->fault);
}

} // namespace abbe::python

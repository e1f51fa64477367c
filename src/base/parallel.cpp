#include "base/parallel.h"

#include "base/work.h"

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#endif
#include <algorithm>
#include <memory>
#include <pmmintrin.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <xmmintrin.h>

namespace abbe {

namespace {
int chosenThreads = 0;
std::unique_ptr<tbb::global_control> control;
} // namespace

void setThreadCount(int threads) {
    chosenThreads = threads;
    control.reset();
    if (threads > 0)
        control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                        static_cast<std::size_t>(threads));
}

int threadCount() { return chosenThreads > 0 ? chosenThreads : tbb::info::default_concurrency(); }

void flushDenormals() {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

#ifdef __SANITIZE_THREAD__
// TBB's library is not instrumented, so that the thread sanitizer sees no order between its tasks and reports races
// everywhere. Under it the loop runs on plain threads.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body) {
    std::atomic<std::size_t> next = 0;
    std::exception_ptr failure;
    std::mutex mutex;
    const auto work = [&] {
        flushDenormals();
        showWork();
        try {
            for (std::size_t i = next++; i < count; i = next++) body(i);
        } catch (...) {
            next = count;
            const std::lock_guard lock(mutex);
            failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> threads;
        for (int i = 1; i < threadCount(); ++i) threads.emplace_back(work);
        work();
    }
    if (failure) std::rethrow_exception(failure);
}
void parallelParts(std::size_t count, const std::function<void(std::size_t)>& body) { parallelFor(count, body); }
#else

namespace {

// A caller that takes part in a loop, and in that of an arena, has its own control register again behind it.
class KeptControl {
  public:
    KeptControl() = default;
    ~KeptControl() { _mm_setcsr(before_); }
    KeptControl(const KeptControl&) = delete;
    KeptControl& operator=(const KeptControl&) = delete;

  private:
    unsigned before_ = _mm_getcsr();
};

void loop(std::size_t count, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            flushDenormals();
            showWork();
            for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
        },
        tbb::simple_partitioner{});
}

} // namespace

// Where nothing else is said, TBB has no more threads at a loop than there are cores. Thousands of them on a few cores
// would do nothing but look for work.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body) {
    constexpr int kMostOfCore = 32;
    const KeptControl kept;
    const int most = std::min(threadCount(), kMostOfCore * tbb::info::default_concurrency());
    if (tbb::this_task_arena::max_concurrency() >= most) return loop(count, body);
    tbb::task_arena arena(most);
    arena.execute([&] { loop(count, body); });
}

void parallelParts(std::size_t count, const std::function<void(std::size_t)>& body) {
    if (count == 1) return body(0);
    const KeptControl kept;
    tbb::this_task_arena::isolate([&] { loop(count, body); });
}
#endif

} // namespace abbe

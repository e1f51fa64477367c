// What every thread is at, for whoever looks on (base/work_clock.h). Telling it costs a store; nobody waits for
// anything.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace abbe {

// Kinds of work that time is charged to. Those of the program as a whole are the work of one thread, whatever helps it.
enum class Work : std::uint8_t {
    none, // nothing to do: between loops, or waiting for other threads
    reading,
    checking,
    building,
    committing, // the acceleration structure
    merging,
    saving, // checkpoints that the program waits for
    certifying,
    writing,
    preparing, // the last of the program as a whole: anything before, between and after these

    camera,
    tracing, // Embree
    surface,
    lights,
    textures,
    motion,
    film,
    volumes = 32, // the first of kVolumeWorks
};
inline constexpr std::size_t kVolumeWorks = 16; // the last one stands for all further media
inline constexpr std::size_t kWorks = static_cast<std::size_t>(Work::volumes) + kVolumeWorks;

// Row of a medium, by its place in Scene::media.
constexpr std::size_t volumeRow(std::size_t medium) { return medium < kVolumeWorks ? medium : kVolumeWorks - 1; }
constexpr Work volumeWork(std::size_t medium) {
    return static_cast<Work>(static_cast<std::size_t>(Work::volumes) + volumeRow(medium));
}

// Circumstances, which may overlap with any work.
enum class WorkFlag : std::uint8_t {
    pilot = 1,    // looking ahead: no sample of the image
    heroOnly = 2, // the path has one wavelength left
    light = 4,    // the path started at a light
};
inline constexpr std::size_t kWorkFlags = 8; // sets of them

// Written by its thread alone, read by all.
struct WorkState {
    std::atomic<std::uint8_t> work{0};  // Work
    std::atomic<std::uint8_t> flags{0}; // WorkFlag
    std::atomic<std::uint8_t> cause{0}; // 0, or 1 + volumeRow() of the medium that scattered the path first

    // What the thread has counted, of its own; whole numbers that follow from its work alone.
    std::uint64_t textureLookups = 0;
    std::uint64_t movingHits = 0; // of surfaces that are elsewhere at other times
};
inline constinit thread_local WorkState workState;

inline void setWork(Work w) { workState.work.store(static_cast<std::uint8_t>(w), std::memory_order_relaxed); }
inline void setWorkCause(std::uint8_t cause) { workState.cause.store(cause, std::memory_order_relaxed); }
inline void setWorkFlags(std::uint8_t flags) { workState.flags.store(flags, std::memory_order_relaxed); }
inline void addWorkFlag(WorkFlag flag) {
    setWorkFlags(workState.flags.load(std::memory_order_relaxed) | static_cast<std::uint8_t>(flag));
}
inline void removeWorkFlag(WorkFlag flag) {
    setWorkFlags(workState.flags.load(std::memory_order_relaxed) & ~static_cast<std::uint8_t>(flag));
}

// This work until the end of the scope, then what was before.
class WorkScope {
  public:
    explicit WorkScope(Work w) : before_(workState.work.load(std::memory_order_relaxed)) { setWork(w); }
    ~WorkScope() { workState.work.store(before_, std::memory_order_relaxed); }
    WorkScope(const WorkScope&) = delete;
    WorkScope& operator=(const WorkScope&) = delete;

  private:
    std::uint8_t before_;
};

// From now on and as long as the thread lives its state can be seen by a WorkClock. Cheap when called again.
void showWork();

} // namespace abbe

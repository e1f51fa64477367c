// The time of a render: the passes of its samples, when it is to end, and when it will.
#pragma once

#include "base/parallel.h"
#include "render/integrator.h"

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace abbe {

// In what portions the samples of a pixel are taken. The end of the pass that begins at sample `first` of a replicate.
// Passes end at powers of two and, from 16 samples on, at quarters in between: every aligned block is a net of its own,
// and a goal is overshot by a quarter at most. The schedule does not depend on the goal, so a render continued with
// more samples takes the same passes.
inline std::uint32_t passEnd(std::uint32_t first) {
    if (first < 2) return 2;
    std::uint32_t power = 1;
    while (power <= first / 2) power *= 2;
    return first + (power >= 16 ? power / 4 : power);
}

// The end of the pass of the whole render that sample `first` belongs to, wherever in it that is.
inline std::uint32_t endOfPassWith(std::uint32_t first) {
    std::uint32_t end = 0;
    while (end <= first) {
        const std::uint32_t next = passEnd(end);
        if (next < end) return 0xffffffff; // beyond 32 bits
        end = next;
    }
    return end;
}

// When a render is to end, for those who are in the middle of a pixel, a path or a pilot. Looks at the clock and at
// whoever may end the render from a thread of its own, so that everyone else looks at one flag. If the system has no
// thread for it the flag stays down, and a render ends between portions alone.
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

// When a render will have met the first of its goals, from how it went so far. Knows no clock and no film: it is told
// what happened when, in seconds since the render began. A sample of a tile is expected to cost what earlier ones of
// the tile did; before there are any, in proportion to what a pilot saw. Error is expected to go on falling by the
// power of the samples by which it fell so far. Not thread-safe.
class TimeLeft {
  public:
    struct Goals {
        SampleRange range;    // of each replicate
        double noise = 0;     // relative error; 0: none
        double timeLimit = 0; // s; 0: none
    };
    struct Forecast {
        double fraction = 0; // of the work, or of the time where that is what ends the render
        double left = -1;    // s; negative: nothing is known yet
    };

    // `tileCosts`: of one sample in each tile, in any unit, > 0.
    TimeLeft(const Goals&, std::vector<double> tileCosts);

    // What an earlier run did. Before begin().
    void alreadyDone(std::size_t tile, std::uint32_t samples, double coreSeconds);
    // The first sample of this run comes now.
    void begin(double now) { began_ = now; }
    // A tile went on by so many samples of each replicate.
    void advanced(std::size_t tile, std::uint32_t samples, double coreSeconds);
    // All tiles are at this sample, and the error is known.
    void passEnded(std::uint32_t reached, double noise);

    Forecast at(double now) const;

  private:
    struct Tile {
        double cost = 1; // predicted
        double samples = 0, seconds = 0;
    };
    struct Point {
        double samples = 0, noise = 0;
    };
    double workUntil(double end) const; // core seconds, of samples that are not yet taken before `end`
    double endByNoise() const;          // sample at which the error will be small enough, on average
    double neededForNoise() const;

    Goals goals_;
    std::vector<Tile> tiles_;
    std::vector<Point> points_; // of ended passes
    double began_ = 0;
    double predicted_ = 0, spent_ = 0; // of samples taken: in the unit of costs, and core seconds
    double spentNow_ = 0;              // core seconds of this run
};

} // namespace abbe

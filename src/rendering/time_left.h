// When a render will have met the first of its goals, from how it went so far.
#pragma once

#include "render/integrator.h"

#include <cstdint>
#include <vector>

namespace abbe {

// Knows no clock and no film: it is told what happened when, in seconds since the render began. A sample of a tile is
// expected to cost what earlier ones of the tile did; before there are any, in proportion to what a pilot saw. Error is
// expected to go on falling by the power of the samples by which it fell so far. Not thread-safe.
class TimeLeft {
  public:
    struct Goals {
        SampleRange range;    // of each replicate
        double noise = 0;     // relative error; 0: none
        double timeLimit = 0; // s; 0: none
    };
    struct Outlook {
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

    Outlook at(double now) const;

  private:
    struct Tile {
        double cost = 1; // foretold
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
    double foretold_ = 0, spent_ = 0; // of samples taken: in the unit of costs, and core seconds
    double spentNow_ = 0;             // core seconds of this run
};

} // namespace abbe

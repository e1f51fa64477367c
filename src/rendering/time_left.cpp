#include "rendering/time_left.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>

namespace abbe {

namespace {
using WatchClock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLookEvery{5};
} // namespace

EndWatch::EndWatch(const StopFlag* asked, double seconds) {
    if (!asked && !(seconds > 0)) return;
    try {
        thread_ = std::thread([this, asked, seconds] { run(asked, seconds); });
    } catch (const std::system_error&) { // see the header
    }
}

EndWatch::~EndWatch() {
    {
        const std::lock_guard lock(mutex_);
        gone_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void EndWatch::run(const StopFlag* asked, double seconds) {
    const auto begin = WatchClock::now();
    const auto timeIsOver = [&] {
        return seconds > 0 && std::chrono::duration<double>(WatchClock::now() - begin).count() >= seconds;
    };
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, kLookEvery, [this] { return gone_; }))
        if ((asked && asked->load(std::memory_order_relaxed)) || timeIsOver()) {
            over_.store(true, std::memory_order_relaxed);
            return;
        }
}

TimeLeft::TimeLeft(const Goals& goals, std::vector<double> tileCosts) : goals_(goals) {
    for (const double cost : tileCosts) tiles_.push_back({cost, 0, 0});
}

void TimeLeft::alreadyDone(std::size_t tile, std::uint32_t samples, double coreSeconds) {
    Tile& t = tiles_[tile];
    t.samples += samples;
    t.seconds += coreSeconds;
    predicted_ += t.cost * samples;
    spent_ += coreSeconds;
}

void TimeLeft::advanced(std::size_t tile, std::uint32_t samples, double coreSeconds) {
    alreadyDone(tile, samples, coreSeconds);
    spentNow_ += coreSeconds;
}

void TimeLeft::passEnded(std::uint32_t reached, double noise) {
    const double samples = static_cast<double>(reached) - goals_.range.first;
    if (noise > 0 && samples > 0) points_.push_back({samples, noise});
}

// What is predicted counts as one sample beside those that were measured.
double TimeLeft::workUntil(double end) const {
    const double unit = predicted_ > 0 ? spent_ / predicted_ : 0;
    const double count = end - goals_.range.first;
    double work = 0;
    for (const Tile& t : tiles_)
        work += std::max(0.0, count - t.samples) * (t.seconds + unit * t.cost) / (t.samples + 1);
    return work;
}

// A line through the logarithms of error and samples, by least squares. Late passes count most: the slope may change.
// Few passes say little about it, and then it is near −1/2. The latest error is taken as the line has it. From there on
// the slope is at least as steep as −1/2: where it was not, the variance only seemed to grow, because rare bright paths
// were still being found for the first time.
double TimeLeft::neededForNoise() const {
    constexpr double kSlope = -0.5, kTrust = 0.05; // of the slope that is assumed
    double sw = 0, sx = 0, sy = 0;
    const double last = points_.back().samples;
    const auto weight = [last](const Point& p) { return p.samples / last; };
    for (const Point& p : points_) {
        sw += weight(p);
        sx += weight(p) * std::log(p.samples);
        sy += weight(p) * std::log(p.noise);
    }
    const double x = sx / sw, y = sy / sw;
    double sxx = kTrust, sxy = kTrust * kSlope;
    for (const Point& p : points_) {
        sxx += weight(p) * square(std::log(p.samples) - x);
        sxy += weight(p) * (std::log(p.samples) - x) * (std::log(p.noise) - y);
    }
    const double fitted = std::clamp(sxy / sxx, -1.5, 0.0), slope = std::min(fitted, -0.5);
    const double here = y + fitted * (std::log(last) - x);
    return last * std::exp((std::log(goals_.noise) - here) / slope);
}

// Passes end where they end, and the error is looked at there alone. As the sample that is needed is not known exactly,
// it is the mean over what it may be.
double TimeLeft::endByNoise() const {
    const double needed = neededForNoise(), next = points_.back().samples + 1;
    double sum = 0;
    int count = 0;
    for (double factor = 0.88; factor < 1.13; factor += 0.04, ++count) {
        const double sample = std::clamp(goals_.range.first + std::max(next, needed * factor), 1.0, 4294967295.0);
        sum += std::min<double>(endOfPassWith(static_cast<std::uint32_t>(std::ceil(sample)) - 1), goals_.range.last);
    }
    return sum / count;
}

TimeLeft::Forecast TimeLeft::at(double now) const {
    if (!(spentNow_ > 0) || !(now > began_)) return {};
    const double speed = spentNow_ / (now - began_); // core seconds per second
    double end = goals_.range.last;
    if (goals_.noise > 0 && !points_.empty()) end = std::min(end, endByNoise());
    const double work = workUntil(end);
    Forecast forecast{spent_ / (spent_ + work), work / speed};
    if (goals_.timeLimit > 0) {
        const double left = std::max(goals_.timeLimit - now, 0.0);
        if (left < forecast.left) forecast = {now / (now + left), left};
    }
    return forecast;
}

} // namespace abbe

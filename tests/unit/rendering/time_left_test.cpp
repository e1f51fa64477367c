// The estimate of the time left, against simulated renders whose end is known: tiles of very different cost, an error
// that falls by any power, threads, a clock of the test's own.
#include "rendering/time_left.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <map>
#include <numeric>
#include <string>

namespace abbe::test {
namespace {

struct Simulation {
    TimeLeft::Goals goals;
    double slope = 0.5;       // error = samples^-slope
    double spread = 3;        // of the logarithms of the tiles' costs
    double foreseen = 0.3;    // standard deviation of the logarithm of what the pilot says about them
    double seenPower = 1;     // of the costs, that the pilot sees: 0 makes tiles alike
    double errorOfNoise = 0;  // relative, of the estimate of the error
    double preparation = 0.5; // s
    std::uint32_t done = 0;   // samples of an earlier run
    int threads = 4;
    std::size_t tiles = 100;
};

// Of one render: what was predicted when, and when it ended.
struct Course {
    std::vector<std::pair<double, TimeLeft::Forecast>> outlooks;
    double end = 0, begin = 0;

    // Largest error of the total that was predicted, relative to the total, of those after this part of the run.
    double worstAfter(double part) const {
        double worst = 0;
        for (const auto& [now, outlook] : outlooks)
            if (now - begin >= part * (end - begin) && outlook.left >= 0)
                worst = std::max(worst, std::abs(now + outlook.left - end) / (end - begin));
        return worst;
    }
};

class Simulator {
  public:
    Simulator(const Simulation& s, std::uint64_t seed) : s_(s), random_(seed), timeLeft_(s.goals, predict()) {}

    Course run() {
        now_ = s_.preparation;
        for (std::size_t i = 0; i < s_.tiles && s_.done > 0; ++i)
            timeLeft_.alreadyDone(i, s_.done, s_.done * costs_[i]);
        timeLeft_.begin(now_);
        course_.begin = now_;
        std::uint32_t reached = s_.goals.range.first + s_.done;
        while (reached < s_.goals.range.last && !ended_) {
            const std::uint32_t end = std::min(endOfPassWith(reached), s_.goals.range.last);
            pass(end - reached);
            if (ended_) break;
            reached = end;
            const double samples = reached - s_.goals.range.first;
            const double noise = std::pow(samples, -s_.slope) * std::exp(s_.errorOfNoise * normal());
            timeLeft_.passEnded(reached, noise);
            ended_ = (s_.goals.noise > 0 && noise <= s_.goals.noise) || timeIsUp(now_);
        }
        course_.end = now_;
        return course_;
    }

  private:
    std::vector<double> predict() {
        std::vector<double> predicted;
        for (std::size_t i = 0; i < s_.tiles; ++i) {
            // Dear tiles lie together at the end, where the first pass comes to last.
            const double place = static_cast<double>(i) / static_cast<double>(s_.tiles);
            costs_.push_back(0.02 * std::exp(s_.spread * place));
            predicted.push_back(100 * std::pow(costs_.back(), s_.seenPower) * std::exp(s_.foreseen * normal()));
        }
        return predicted;
    }
    double normal() {
        return std::sqrt(-2 * std::log(random_.uniformDouble())) * std::cos(6.283185307 * random_.uniformDouble());
    }
    bool timeIsUp(double now) const { return s_.goals.timeLimit > 0 && now > s_.goals.timeLimit; }

    // Each tile goes to the thread that is free first.
    void pass(std::uint32_t samples) {
        std::multimap<double, std::size_t> events; // when a thread is done with a tile
        std::size_t next = 0;
        const auto begin = [&] {
            if (next < s_.tiles && !timeIsUp(now_)) events.emplace(now_ + samples * costs_[next], next), ++next;
        };
        for (int t = 0; t < s_.threads; ++t) begin();
        while (!events.empty()) {
            const auto [when, tile] = *events.begin();
            events.erase(events.begin());
            now_ = when;
            timeLeft_.advanced(tile, samples, samples * costs_[tile]);
            course_.outlooks.emplace_back(now_, timeLeft_.at(now_));
            begin();
        }
        ended_ = next < s_.tiles;
    }

    Simulation s_;
    Random random_;
    std::vector<double> costs_;
    TimeLeft timeLeft_;
    Course course_;
    double now_ = 0;
    bool ended_ = false;
};

// The largest error of some renders.
double worst(const Simulation& s, double part = 0.1) {
    double most = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Course course = Simulator(s, seed).run();
        REQUIRE(course.outlooks.size() > 20);
        most = std::max(most, course.worstAfter(part));
    }
    return most;
}

} // namespace

TEST_CASE("time left: a number of samples, with tiles of very different cost") {
    for (const std::uint32_t samples : {8u, 32u, 50u, 1000u})
        for (const double spread : {0.0, 3.0, 5.0}) {
            CAPTURE(samples);
            CAPTURE(spread);
            Simulation s;
            s.goals.range = {0, samples};
            s.spread = spread;
            CHECK(worst(s) < 0.2);
        }
    Simulation blind; // then what was measured counts, from the second pass on
    blind.seenPower = blind.foreseen = 0;
    blind.goals.range = {0, 40};
    blind.spread = 5;
    CHECK(worst(blind) < 0.2);
}

TEST_CASE("time left: an error, whatever power of the samples it falls by") {
    for (const double slope : {0.5, 0.6, 0.75})
        for (const double needed : {100.0, 300.0, 1100.0}) {
            CAPTURE(slope);
            CAPTURE(needed);
            Simulation s;
            s.goals = {{0, 1u << 30}, std::pow(needed, -slope), 0};
            s.slope = slope;
            s.errorOfNoise = 0.005;
            s.tiles = 40;
            CHECK(worst(s) < 0.2);
        }
}

TEST_CASE("time left: an error that falls slowly while rare bright paths are first found, then as any") {
    TimeLeft left({{0, 1u << 30}, 0.03, 0}, {1});
    left.begin(0);
    // Of glass-caustic, 96 × 96 pixels and two replicates; 3 % were reached with 384 samples of each.
    const std::pair<std::uint32_t, double> passes[] = {
        {8, 0.120},   {16, 0.0942}, {20, 0.0879}, {24, 0.0829}, {28, 0.0774}, {32, 0.0726}, {40, 0.0670},
        {48, 0.0632}, {56, 0.0605}, {64, 0.0597}, {80, 0.0550}, {96, 0.0523}, {112, 0.0497}};
    std::uint32_t before = 0;
    for (const auto& [samples, noise] : passes) {
        left.advanced(0, samples - before, samples - before);
        left.passEnded(samples, noise);
        before = samples;
    }
    CHECK(before + left.at(before).left == doctest::Approx(384).epsilon(0.2)); // the line alone says 512
}

TEST_CASE("time left: a time, and whichever goal comes first") {
    Simulation s;
    s.goals = {{0, 1u << 30}, 0, 60};
    CHECK(worst(s) < 0.05);
    s.goals.timeLimit = 2; // within the first pass
    CHECK(worst(s) < 0.2);
    s.goals = {{0, 200}, std::pow(100.0, -0.5), 1e6};
    CHECK(worst(s) < 0.2);
    s.goals = {{0, 60}, std::pow(1000.0, -0.5), 1e6};
    CHECK(worst(s) < 0.2);
    s.goals = {{0, 1000}, std::pow(1000.0, -0.5), 30};
    CHECK(worst(s) < 0.2);
}

TEST_CASE("time left: of continued renders and of parts, only what is still to be done") {
    Simulation s;
    s.goals.range = {0, 400};
    s.done = 256;
    CHECK(worst(s) < 0.2);
    s.goals = {{300, 400}, 0, 0}; // the last quarter, say
    s.done = 0;
    CHECK(worst(s) < 0.2);
    const TimeLeft fresh({{0, 10}, 0, 0}, {1, 1});
    CHECK(fresh.at(5).left < 0); // nothing is known yet
    CHECK(fresh.at(5).fraction == 0);
}

TEST_CASE("time left: the fraction grows from what was done before to one") {
    Simulation s;
    s.goals.range = {0, 64};
    s.done = 32;
    const Course course = Simulator(s, 3).run();
    CHECK(course.outlooks.front().second.fraction > 0.4);
    CHECK(course.outlooks.front().second.fraction < 0.6);
    CHECK(course.outlooks.back().second.fraction == doctest::Approx(1));
    CHECK(course.outlooks.back().second.left == doctest::Approx(0));
}

} // namespace abbe::test

#include "verify/verify_run.h"

#include "base/stopwatch.h"
#include "film/film_params.h"
#include "math/vec.h"
#include "render/render_state.h"
#include "rendering/path_tracer.h"
#include "verify/tile_sums.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace abbe {

namespace {

// With more lights than this a choice by power is far noisier than one by place.
constexpr std::size_t kFewLights = 8;

} // namespace

std::array<Estimator, 2> verifyEstimators(std::size_t lights) {
    using T = Technique;
    T scattering, nee;
    scattering.weights = T::Weights::scattering;
    nee.weights = T::Weights::lights;
    nee.directions = T::Directions::mixed;
    nee.numbers = T::Numbers::random;
    nee.roulette = T::Roulette::throughput;
    if (lights <= kFewLights) nee.lightChoice = T::LightChoice::power;
    return {{{"scattering", "directions and weights as surfaces sample them; light found by scattering", scattering},
             {"nee", "half of the directions uniform, weighted by values; next-event estimation; independent numbers",
              nee}}};
}

namespace {

constexpr int kReplicates = 32;
constexpr std::uint32_t kPilotSamples = 4; // of each replicate
// Of a resolution that is planned for: a pilot knows a variance to a few tens of percent.
constexpr double kReserve = 0.9;
constexpr std::uint32_t kMostSamples = 1u << 24;

// One estimator's picture.
struct Picture {
    std::optional<TileSums> sums;
    RenderStatistics statistics;
    double seconds = 0;

    // Relative variance of the picture's mean Y.
    double variance() const {
        const ReplicateMean y(sums->whole(), 1);
        return y.value != 0 ? y.variance / square(y.value) : 0;
    }
    double rays() const { return static_cast<double>(statistics.rays() + statistics.pilotRays); }
};

class VerifyRun {
  public:
    VerifyRun(const BuiltScene& built, const VerifyPlan& plan, const VerifyControl& control)
        : built_(built), plan_(plan), control_(control), estimators_(verifyEstimators(built.scene.lights.size())) {}

    std::optional<VerifyReport> run() {
        const Stopwatch clock;
        VerifyReport report;
        std::array<std::uint32_t, 2> samples{};
        if (plan_.samples) {
            samples.fill(std::max(1u, (*plan_.samples + kReplicates - 1) / kReplicates));
        } else if (!choose(samples, report.timeLimited)) {
            return std::nullopt;
        }
        std::array<Picture, 2> pictures;
        const double total = cost_[0] * samples[0] + cost_[1] * samples[1];
        double done = 0;
        for (std::size_t i = 0; i < 2; ++i) {
            const double own = cost_[i] * samples[i] / total;
            if (!render(i, samples[i], 2 + i, pictures[i], done, own)) return std::nullopt;
            done += own;
            report.sides[i] = {estimators_[i], samples[i] * kReplicates, pictures[i].statistics.rays(),
                               droppedOf(pictures[i]), std::sqrt(pictures[i].variance())};
        }
        report.agreement = compare(*pictures[0].sums, *pictures[1].sums, plan_.level);
        report.seconds = clock.seconds();
        return report;
    }

  private:
    static std::uint64_t droppedOf(const Picture& p) {
        const auto& d = p.statistics.dropped;
        return std::accumulate(d.begin(), d.end(), std::uint64_t{0});
    }
    bool choose(std::array<std::uint32_t, 2>& samples, bool& timeLimited);
    bool render(std::size_t estimator, std::uint32_t samplesPerReplicate, std::uint64_t seed, Picture&, double done,
                double share);

    const BuiltScene& built_;
    const VerifyPlan& plan_;
    const VerifyControl& control_;
    std::array<Estimator, 2> estimators_;
    std::array<double, 2> cost_{1, 1}; // rays of a sample of each replicate
};

// With variances v/n and costs c the least cost of a variance V of the difference is at
// n_i = √(v_i/c_i) (√(v_a c_a) + √(v_b c_b))/V.
bool VerifyRun::choose(std::array<std::uint32_t, 2>& samples, bool& timeLimited) {
    std::array<double, 2> variance{}; // of one sample of each replicate
    double seconds = 0, rays = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        Picture pilot;
        if (!render(i, kPilotSamples, i, pilot, 0, 0)) return false;
        variance[i] = pilot.variance() * kPilotSamples;
        cost_[i] = pilot.rays() / kPilotSamples;
        seconds += pilot.seconds;
        rays += pilot.rays();
    }
    const double goal = square(kReserve * plan_.resolution);
    const double both = std::sqrt(variance[0] * cost_[0]) + std::sqrt(variance[1] * cost_[1]);
    std::array<double, 2> n{};
    for (std::size_t i = 0; i < 2; ++i)
        n[i] = std::max<double>(kPilotSamples, std::sqrt(variance[i] / cost_[i]) * both / goal);
    const double needed = (n[0] * cost_[0] + n[1] * cost_[1]) * seconds / rays;
    const double allowed = std::max(0.0, plan_.timeLimit - seconds);
    timeLimited = needed > allowed;
    for (std::size_t i = 0; i < 2; ++i) {
        if (timeLimited) n[i] *= allowed / needed;
        if (n[i] > kMostSamples) timeLimited = true;
        samples[i] = static_cast<std::uint32_t>(std::clamp<double>(std::ceil(n[i]), 1, kMostSamples));
    }
    return true;
}

bool VerifyRun::render(std::size_t estimator, std::uint32_t samplesPerReplicate, std::uint64_t seed, Picture& picture,
                       double done, double share) {
    const FilmSettings film = filmSettings(built_.film);
    PixelFilm image({0, 0, film.width, film.height}, PixelFilter(film.filter, film.filterRadius), kReplicates);
    RenderSettings settings = renderSettings(built_.render);
    settings.samples = samplesPerReplicate * kReplicates;
    settings.seed = 4 * plan_.seed + seed; // pilots and pictures of all seeds are different ones
    settings.noiseTarget = settings.timeLimit = 0;
    settings.part = settings.parts = 1;
    settings.adaptive = false;
    settings.technique = estimators_[estimator].technique;
    RenderControl control{control_.stop, {}};
    if (control_.progress) control.progress = [&](const Progress& p) { control_.progress(done + share * p.fraction); };
    const Stopwatch clock;
    const auto integrator = makePathTracer(built_.scene.effects);
    image.keepSplatsOf(*integrator, built_.scene, settings);
    picture.statistics = integrator->render(built_.scene, image, settings, control);
    picture.seconds = clock.seconds();
    if (picture.statistics.stopped) return false;
    picture.sums.emplace(image);
    return true;
}

} // namespace

std::optional<VerifyReport> verify(const BuiltScene& built, const VerifyPlan& plan, const VerifyControl& control) {
    return VerifyRun(built, plan, control).run();
}

} // namespace abbe

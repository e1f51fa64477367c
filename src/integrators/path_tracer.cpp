#include "integrators/path_tracer.h"

#include "base/parallel.h"
#include "integrators/pass_schedule.h"
#include "integrators/tile_kernel.h"

#include <chrono>
#include <ctime>
#include <mutex>

namespace abbe {

namespace {

constexpr int kTileSize = 16;

struct Kernel {
    Effects effects;
    const char* name;
    TileFunction render;
};
template <EffectBits E> constexpr Kernel kernel(const char* name) {
    return {Effects::fromBits(E), name, renderTile<E>};
}
// The cheapest first.
constexpr Kernel kKernels[] = {
    kernel<kPlainKernel.bits()>("plain"),
    kernel<kTexturesKernel.bits()>("textures"),
    kernel<kAbsorptionKernel.bits()>("absorption"),
    kernel<kInterfacesKernel.bits()>("absorption+textures+interfaces"),
    kernel<kDispersionKernel.bits()>("absorption+dispersion"),
    kernel<kSpectralInterfacesKernel.bits()>("absorption+textures+interfaces+dispersion"),
    kernel<kMediaKernel.bits()>("absorption+textures+interfaces+media"),
    kernel<kFullKernel.bits()>("all"),
};

double threadSeconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

std::vector<PixelBounds> makeTiles(PixelBounds b) {
    std::vector<PixelBounds> tiles;
    for (int y = b.y0; y < b.y1; y += kTileSize)
        for (int x = b.x0; x < b.x1; x += kTileSize)
            tiles.push_back({x, y, std::min(x + kTileSize, b.x1), std::min(y + kTileSize, b.y1)});
    return tiles;
}

bool drawsChoices(const Scene& scene, const LightSampler& lights) {
    return lights.needsChoice() || scene.camera->usesLens() ||
           std::any_of(scene.materials.begin(), scene.materials.end(), [](const auto& m) { return m->choosesLobe(); });
}

// One render from the first pass to the last: owns the schedule, the statistics and the talk with the caller.
class RenderJob {
  public:
    RenderJob(const Kernel& kernel, const Scene& scene, Film& film, const RenderSettings& settings,
              const RenderControl& control)
        : kernel_(kernel), film_(film), settings_(settings), control_(control),
          lights_(scene.lights, settings.lightChoice), context_{scene, lights_, settings, drawsChoices(scene, lights_)},
          tiles_(makeTiles(film.bounds())) {
        const auto replicates = static_cast<std::uint32_t>(film.replicates());
        perReplicate_ = std::max<std::uint32_t>(1, (settings.samples + replicates - 1) / replicates);
        statistics_.kernel = kernel.name;
    }

    RenderStatistics run() {
        lookAhead();
        std::uint32_t first = 0;
        while (first < perReplicate_ && !ended()) {
            const std::uint32_t last = std::min(passEnd(first), perReplicate_);
            runPass(first, last);
            if (unfinished_) break;
            first = last;
            ++pass_;
            statistics_.samplesPerPixel = first * static_cast<std::uint32_t>(film_.replicates());
            statistics_.noise = film_.relativeNoise();
        }
        statistics_.seconds = elapsed();
        report(statistics_.samplesPerPixel, 1);
        return std::move(statistics_);
    }

  private:
    using Clock = std::chrono::steady_clock;

    double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    bool stopRequested() const {
        if (control_.stop && control_.stop->load(std::memory_order_relaxed)) return true;
        return settings_.timeLimit > 0 && pass_ > 0 && elapsed() > settings_.timeLimit;
    }
    bool ended() const {
        if (settings_.noiseTarget > 0 && statistics_.noise > 0 && statistics_.noise <= settings_.noiseTarget)
            return true;
        return stopRequested();
    }

    // Samples of a seed of its own, which are never part of the image.
    void lookAhead() {
        constexpr std::uint64_t kPilot = 0x70696c6f74; // "pilot"
        const PixelBounds frame = context_.scene.frame.area() > 0 ? context_.scene.frame : film_.bounds();
        PilotFilm pilot(frame, combine64(settings_.seed, kPilot));
        PathContext context = context_;
        context.settings.seed = combine64(settings_.seed, kPilot);
        parallelFor(static_cast<std::size_t>(pilot.rows()), [&](std::size_t row) {
            for (int column = 0; column < pilot.columns() && !stopRequested(); ++column)
                kernel_.render(context, pilot,
                               {pilot.pixelOf(column, static_cast<int>(row)), 0, PilotFilm::kSamples, &roulette_});
        });
        roulette_ = RouletteReference(pilot);
    }

    void runPass(std::uint32_t first, std::uint32_t last) {
        std::size_t done = 0;
        parallelFor(tiles_.size(), [&](std::size_t i) {
            if (stopRequested()) return;
            const double before = threadSeconds();
            const TileResult result = kernel_.render(context_, film_, {tiles_[i], first, last, &roulette_});
            const double seconds = threadSeconds() - before;
            const std::lock_guard lock(mutex_);
            merge(result, seconds);
            ++done;
            maybeReport(first + static_cast<double>(done) / static_cast<double>(tiles_.size()) * (last - first));
        });
        unfinished_ = done < tiles_.size();
        statistics_.stopped = unfinished_ && control_.stop && control_.stop->load();
    }

    // Sums of integers: the same in any order.
    void merge(const TileResult& r, double seconds) {
        statistics_.paths += r.counters.paths;
        statistics_.vertices += r.counters.vertices;
        statistics_.shadowRays += r.counters.shadowRays;
        statistics_.cappedPaths += r.counters.capped;
        statistics_.excess.add(r.excess);
        statistics_.coreSeconds += seconds;
        for (std::size_t i = 0; i < r.dropped.size(); ++i) statistics_.dropped[i] += r.dropped[i];
        for (const DroppedSample& s : r.examples)
            if (statistics_.examples.size() < 4) statistics_.examples.push_back(s);
    }

    void maybeReport(double samplesPerReplicate) {
        const double now = elapsed();
        if (now - lastReport_ < 0.1) return;
        lastReport_ = now;
        report(static_cast<std::uint32_t>(samplesPerReplicate * film_.replicates()),
               samplesPerReplicate / perReplicate_);
    }

    void report(std::uint32_t samples, double fraction) {
        if (!control_.progress) return;
        Progress p;
        p.elapsed = elapsed();
        p.pass = pass_;
        p.samplesPerPixel = samples;
        p.totalSamples = perReplicate_ * static_cast<std::uint32_t>(film_.replicates());
        p.noise = statistics_.noise;
        p.pathsPerSecond = p.elapsed > 0 ? static_cast<double>(statistics_.paths) / p.elapsed : 0;
        p.fraction = goalFraction(fraction, samples);
        if (p.fraction > 0) p.left = p.elapsed * (1 - p.fraction) / p.fraction;
        control_.progress(p);
    }

    // Of the work until the goal that will be met first. Error falls about as samples^-1/2, so the samples that a
    // noise goal needs grow with the square of the error's ratio.
    double goalFraction(double bySamples, std::uint32_t samples) const {
        double fraction = bySamples;
        if (settings_.timeLimit > 0) fraction = std::max(fraction, elapsed() / settings_.timeLimit);
        if (settings_.noiseTarget > 0 && statistics_.noise > 0 && statistics_.samplesPerPixel > 0) {
            const double needed = statistics_.samplesPerPixel * square(statistics_.noise / settings_.noiseTarget);
            fraction = std::max(fraction, samples / std::max(1.0, needed));
        }
        return std::min(1.0, fraction);
    }

    const Kernel& kernel_;
    Film& film_;
    RenderSettings settings_;
    const RenderControl& control_;
    LightSampler lights_;
    PathContext context_;
    RouletteReference roulette_;
    std::vector<PixelBounds> tiles_;
    std::uint32_t perReplicate_ = 0;
    std::uint32_t pass_ = 0;
    RenderStatistics statistics_;
    std::mutex mutex_;
    Clock::time_point start_ = Clock::now();
    double lastReport_ = 0;
    bool unfinished_ = false; // the last pass was cut short
};

class PathTracer final : public Integrator {
  public:
    explicit PathTracer(const Kernel& kernel) : kernel_(kernel) {}
    RenderStatistics render(const Scene& scene, Film& film, const RenderSettings& settings,
                            const RenderControl& control) const override {
        return RenderJob(kernel_, scene, film, settings, control).run();
    }

  private:
    const Kernel& kernel_;
};

} // namespace

std::unique_ptr<const Integrator> makePathTracer(Effects required) {
    for (const Kernel& kernel : kKernels)
        if (kernel.effects.contains(required)) return std::make_unique<PathTracer>(kernel);
    return std::make_unique<PathTracer>(std::end(kKernels)[-1]);
}

} // namespace abbe

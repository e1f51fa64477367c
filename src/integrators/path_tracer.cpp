#include "integrators/path_tracer.h"

#include "base/check.h"
#include "base/parallel.h"
#include "integrators/pass_schedule.h"
#include "integrators/plan_film.h"
#include "integrators/render_plans.h"
#include "integrators/time_left.h"
#include "render/render_state.h"

#include <array>
#include <chrono>
#include <ctime>
#include <mutex>
#include <optional>
#include <utility>

namespace abbe {

namespace {

// At most about this long is a tile in one thread's hands, so that a render ends soon when it is told to.
constexpr double kPortionSeconds = 0.4;
// s: a portion that is foretold to go on for longer than this after the time limit is not begun.
constexpr double kOvertime = 0.1;

struct Kernel {
    Effects effects;
    const char* name;
    TileFunction render;
    const TracedKernel& traced() const { return effects.has(Effect::media) ? kTracedFull : kTracedInterfaces; }
};
template <EffectBits E> constexpr Kernel kernel(const char* name) {
    return {Effects::fromBits(E), name, renderTile<E>};
}
// The cheapest first.
constexpr Kernel kAllKernels[] = {
    kernel<kPlainKernel.bits()>("plain"),
    kernel<kTexturesKernel.bits()>("textures"),
    kernel<kAbsorptionKernel.bits()>("absorption"),
    kernel<kInterfacesKernel.bits()>("absorption+textures+interfaces"),
    kernel<kDispersionKernel.bits()>("absorption+dispersion"),
    kernel<kSpectralInterfacesKernel.bits()>("absorption+textures+interfaces+dispersion"),
    kernel<kMediaKernel.bits()>("absorption+textures+interfaces+media"),
    kernel<kFullKernel.bits()>("all"),
};

// Those that this build has.
template <std::size_t... I> constexpr auto compiledKernels(std::index_sequence<I...>) {
    constexpr std::size_t count = (std::size_t{kCompiledEffects.contains(kAllKernels[I].effects)} + ...);
    std::array<Kernel, count> kernels{};
    std::size_t next = 0;
    for (const Kernel& k : kAllKernels)
        if (kCompiledEffects.contains(k.effects)) kernels[next++] = k;
    return kernels;
}
constexpr auto kKernels = compiledKernels(std::make_index_sequence<std::size(kAllKernels)>());

double threadSeconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

PathTally tallyOf(const TileResult& r, double seconds) {
    const PathCounters& c = r.counters;
    if (r.lightPaths == 0)
        return {c.paths, c.vertices, c.shadowRays, c.capped, r.dropped, r.excess, c.effects, seconds, 0, 0, 0, 0};
    const std::uint64_t rays = c.vertices + c.shadowRays + c.effects.crossings + c.effects.shadowCrossings;
    return {0, 0, 0, c.capped, r.dropped, r.excess, {}, seconds, r.lightPaths, rays, r.splats, r.rounds};
}

bool drawsChoices(const Scene& scene, const LightSampler& lights, const Technique& technique) {
    return lights.needsChoice() || technique.directions != Technique::Directions::importance ||
           scene.camera->usesLens() ||
           std::any_of(scene.materials.begin(), scene.materials.end(), [](const auto& m) { return m->choosesLobe(); });
}

// One render from the first pass to the last: owns the schedule, the statistics and the talk with the caller.
class RenderJob {
  public:
    RenderJob(const Kernel& kernel, const Scene& scene, Film& film, const RenderSettings& settings,
              const RenderControl& control)
        : kernel_(kernel), film_(film), settings_(settings), control_(control),
          lights_(scene.lights, settings.technique.lightChoice),
          context_{scene, lights_, settings, drawsChoices(scene, lights_, settings.technique),
                   settings.samplesPerReplicate(film.replicates())},
          range_(settings.range(film.replicates())), ownState_(ownState(scene, film, settings, control)),
          state_(control.state ? *control.state : *ownState_), pass_(passesBefore(state_.reached())) {
        statistics_.kernel = kernel.name;
        count(state_.tally());
    }

    RenderStatistics run() {
        plan(context_);
        beginTiming();
        rendering_ = true;
        if (pass_ > 0 && state_.even()) endPass();
        while (state_.reached() < range_.last && !ended()) {
            runPass(std::min(nextEnd(), range_.last));
            if (unfinished_) break;
            ++pass_;
            endPass();
        }
        describe(statistics_);
        statistics_.stopped =
            control_.stop && control_.stop->load() && state_.reached() < range_.last && !quietEnough();
        report(1);
        return std::move(statistics_);
    }

    LightPathFindings lightPaths() {
        plan(context_);
        return statistics_.lightPlan;
    }

    void repeat(std::span<const SampleId> samples) {
        PathContext even = context_; // a sample is named by its place in the sequence, whatever the plan
        even.settings.adaptive = false;
        even.settings.timeLimit = 0;
        plan(even);
        for (const SampleId& s : samples)
            render_(context_, film_, {{s.x, s.y, s.x + 1, s.y + 1}, s.index, s.index + 1, &plans_.ahead.roulette});
    }

  private:
    using Clock = std::chrono::steady_clock;

    void plan(const PathContext& context) {
        const std::function<double()> left = [this] { return timeLeft(); };
        const std::function<bool()> stop = [this] { return stopRequested(); };
        plans_ = planRender({context, kernel_.render, kernel_.traced(), film_, state_, control_.firstLook, left, stop});
        statistics_.lightPlan = plans_.findings;
        statistics_.pilotRays = plans_.rays;
        statistics_.pilotSeconds = plans_.seconds;
        plans_.caustics.giveTo(context_);
        if (plans_.caustics.any()) render_ = kernel_.traced().render;
    }

    static std::optional<RenderState> ownState(const Scene& scene, const Film& film, const RenderSettings& settings,
                                               const RenderControl& control) {
        if (control.state) return std::nullopt;
        const std::size_t blocks = film.takesSplats() ? lightBlocksOf(scene, settings.technique) : 0;
        return std::optional<RenderState>(std::in_place, film.bounds(), settings.range(film.replicates()).first,
                                          blocks);
    }
    // Passes of this range that end at or before a sample.
    std::uint32_t passesBefore(std::uint32_t sample) const {
        std::uint32_t count = 0;
        for (std::uint32_t end = range_.first; (end = endOfPassWith(end)) <= sample;) ++count;
        return count;
    }
    bool snapshotRequested() const { return control_.snapshot && control_.snapshot->load(std::memory_order_relaxed); }
    double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    bool stopRequested() const {
        if (control_.stop && control_.stop->load(std::memory_order_relaxed)) return true;
        return mayEndInTime() && timeLeft() < 0;
    }
    double timeLeft() const { return settings_.timeLimit - elapsed(); } // s, if there is a limit
    // Whether the time limit counts by now.
    bool mayEndInTime() const { return settings_.timeLimit > 0 && rendering_ && (pass_ > 0 || !plans_.caustics.any()); }
    bool quietEnough() const {
        return settings_.noiseTarget > 0 && statistics_.noise > 0 && statistics_.noise <= settings_.noiseTarget &&
               state_.reached() >= state_.first() + 2; // two samples alike are chance
    }
    bool ended() const { return quietEnough() || stopRequested(); }

    void beginTiming() {
        timeLeft_.emplace(TimeLeft::Goals{range_, settings_.noiseTarget, settings_.timeLimit}, plans_.ahead.tileCosts);
        for (std::size_t i = 0; i < state_.tileCount(); ++i) {
            const TileState& tile = state_.tile(i);
            timeLeft_->alreadyDone(i, tile.reached - state_.first(), tile.tally.coreSeconds);
            pixelSamples_ += state_.pixels(i).area() * (tile.reached - state_.first());
        }
        timeLeft_->begin(elapsed());
    }

    // Where time is short, the first pass has but one sample of each replicate.
    std::uint32_t nextEnd() const {
        const std::uint32_t reached = state_.reached();
        return settings_.timeLimit > 0 && reached == state_.first() ? reached + 1 : endOfPassWith(reached);
    }

    // All tiles up to sample `last`, as far as nobody ends it.
    void runPass(std::uint32_t last) {
        std::vector<std::size_t> open;
        for (std::size_t i = 0; i < state_.tileCount(); ++i)
            if (state_.tile(i).reached < last) open.push_back(i);
        bool goesOn = true; // else what is left of the pass would end after the time limit
        do {
            advanced_ = false;
            parallelFor(open.size(), [&](std::size_t i) { advance(open[i], last); });
            goesOn = advanced_ || snapshotRequested();
            if (snapshotRequested()) takeSnapshot();
            std::erase_if(open, [&](std::size_t i) { return state_.tile(i).reached >= last; });
        } while (!open.empty() && goesOn && !stopRequested());
        unfinished_ = !open.empty();
    }

    void advance(std::size_t i, std::uint32_t last) {
        TileState& tile = state_.tile(i);
        while (tile.reached < last && !stopRequested() && !snapshotRequested()) {
            PathTally tally;
            ManifoldCounts chains;
            const std::uint32_t first = tile.reached;
            {
                const auto hold = state_.hold(i);
                const std::uint32_t end = std::min(last, tile.reached + portion(tile));
                if (end == tile.reached) return;
                advanced_ = true;
                const double before = threadSeconds();
                const TileResult result = work(i, first, end);
                tally = tallyOf(result, threadSeconds() - before);
                chains = result.counters.manifold;
                tile.tally.add(tally);
                tile.reached = end;
                for (const DroppedSample& s : result.examples)
                    if (tile.examples.size() < TileState::kExamples) tile.examples.push_back(s);
            }
            const std::lock_guard lock(mutex_);
            count(tally);
            statistics_.manifoldEstimates += chains.estimates;
            statistics_.manifoldTrials += chains.trials;
            statistics_.manifoldCapped += chains.capped;
            timeLeft_->advanced(i, tile.reached - first, tally.coreSeconds);
            pixelSamples_ += state_.pixels(i).area() * (tile.reached - first);
            maybeReport();
        }
    }

    TileResult work(std::size_t i, std::uint32_t first, std::uint32_t end) {
        if (!state_.isLightBlock(i))
            return render_(context_, film_, {state_.pixels(i), first, end, &plans_.ahead.roulette, samplePlan()});
        return workOnBlock(static_cast<std::uint32_t>(state_.lightBlock(i)), first, end);
    }

    // A share of the light paths, and some of the rounds of merging.
    TileResult workOnBlock(std::uint32_t block, std::uint32_t first, std::uint32_t end) {
        const auto blocks = static_cast<std::uint32_t>(state_.lightBlockCount());
        TileResult result;
        if (plans_.caustics.light.plan) {
            const std::uint64_t paths = plans_.caustics.light.plan->paths;
            result = kernel_.traced().trace(context_, film_,
                                            {static_cast<std::uint32_t>(paths * block / blocks),
                                             static_cast<std::uint32_t>(paths * (block + 1) / blocks), first, end});
        }
        if (plans_.caustics.merging.plan)
            result.add(kernel_.traced().merge(context_, film_, {first, end, block, blocks}, nullptr));
        return result;
    }

    const SamplingPlan* samplePlan() const { return plans_.ahead.plan.even() ? nullptr : &plans_.ahead.plan; }

    // How many samples of each replicate are taken in one go; none if even one would end after the time limit.
    std::uint32_t portion(const TileState& tile) const {
        const std::uint32_t done = tile.reached - state_.first();
        if (done == 0) return settings_.timeLimit > 0 ? 1 : 2;
        const double each = std::max(tile.tally.coreSeconds, 1e-6) / done;
        double seconds = kPortionSeconds;
        if (mayEndInTime()) {
            if (each > timeLeft() + kOvertime) return 0;
            seconds = std::min(seconds, timeLeft());
        }
        return static_cast<std::uint32_t>(std::clamp(seconds / each, 1.0, 1e6));
    }

    void takeSnapshot() {
        control_.snapshot->store(false);
        RenderStatistics now = statistics_;
        describe(now);
        now.stopped = true;
        control_.takeSnapshot(now);
    }

    // What is not counted on the way.
    void describe(RenderStatistics& s) const {
        s.samplesPerPixel = finishedSamples();
        s.seconds = state_.seconds + elapsed();
        s.examples = state_.examples();
    }

    std::uint32_t finishedSamples() const {
        return (state_.reached() - state_.first()) * static_cast<std::uint32_t>(film_.replicates());
    }

    void endPass() {
        const WorkScope work(Work::film);
        statistics_.samplesPerPixel = finishedSamples();
        statistics_.noise = film_.relativeNoise();
        timeLeft_->passEnded(state_.reached(), statistics_.noise);
        if (control_.passEnded) control_.passEnded();
    }

    void count(const PathTally& t) {
        statistics_.paths += t.paths;
        statistics_.vertices += t.vertices;
        statistics_.shadowRays += t.shadowRays;
        statistics_.cappedPaths += t.cappedPaths;
        statistics_.excess.add(t.excess);
        statistics_.effects.add(t.effects);
        statistics_.coreSeconds += t.coreSeconds;
        statistics_.lightPaths += t.lightPaths;
        statistics_.lightRays += t.lightRays;
        statistics_.splats += t.splats;
        statistics_.rounds += t.rounds;
        for (std::size_t i = 0; i < t.dropped.size(); ++i) statistics_.dropped[i] += t.dropped[i];
    }

    void maybeReport() {
        const double now = elapsed();
        if (now - lastReport_ < 0.1) return;
        lastReport_ = now;
        report(0);
    }

    // `least`: of the fraction, for the end.
    void report(double least) {
        if (!control_.progress) return;
        const auto replicates = static_cast<std::uint32_t>(film_.replicates());
        Progress p;
        p.elapsed = elapsed();
        p.pass = pass_;
        p.samplesPerPixel = static_cast<std::uint32_t>(pixelSamples_ * replicates / film_.bounds().area());
        p.totalSamples = (range_.last - range_.first) * replicates;
        p.noise = statistics_.noise;
        p.pathsPerSecond = p.elapsed > 0 ? static_cast<double>(statistics_.paths - pathsBefore_) / p.elapsed : 0;
        p.coreSeconds = statistics_.coreSeconds;
        const TimeLeft::Outlook outlook = timeLeft_->at(p.elapsed);
        p.fraction = std::max(least, outlook.fraction);
        p.left = least < 1 ? outlook.left : 0;
        control_.progress(p);
    }

    const Kernel& kernel_;
    Film& film_;
    RenderSettings settings_;
    const RenderControl& control_;
    LightSampler lights_;
    PathContext context_;
    RenderPlans plans_;
    TileFunction render_ = kernel_.render; // of pixels
    SampleRange range_;
    std::optional<RenderState> ownState_; // unless the caller has one
    RenderState& state_;
    std::uint32_t pass_ = 0;
    RenderStatistics statistics_;
    std::optional<TimeLeft> timeLeft_; // from the first sample on
    std::int64_t pixelSamples_ = 0;    // of each replicate, in all pixels, as if they were even
    std::mutex mutex_;
    Clock::time_point start_ = Clock::now();
    double lastReport_ = 0;
    std::uint64_t pathsBefore_ = state_.tally().paths; // of earlier runs
    bool unfinished_ = false;                          // the last pass was cut short
    bool rendering_ = false;                           // samples are taken
    std::atomic<bool> advanced_ = false;               // any tile, since asked last
};

class PathTracer final : public Integrator {
  public:
    explicit PathTracer(const Kernel& kernel) : kernel_(kernel) {}
    RenderStatistics render(const Scene& scene, Film& film, const RenderSettings& settings,
                            const RenderControl& control) const override {
        return RenderJob(kernel_, scene, film, settings, control).run();
    }
    void repeat(const Scene& scene, Film& film, const RenderSettings& settings,
                std::span<const SampleId> samples) const override {
        RenderJob(kernel_, scene, film, settings, {}).repeat(samples);
    }
    std::size_t lightBlocks(const Scene& scene, const RenderSettings& settings) const override {
        return lightBlocksOf(scene, settings.technique);
    }
    bool merges(const Scene&, const RenderSettings& settings) const override {
        return settings.technique.merging != Technique::Merging::off;
    }
    LightPathFindings findLightPaths(const Scene& scene, const Film& like,
                                     const RenderSettings& settings) const override {
        LightPathFindings known;
        known.verdict = lightPathVerdict(scene, settings.technique);
        if (lightBlocks(scene, settings) == 0) return known;
        RenderSettings even = settings; // a plan of the samples changes nothing
        even.adaptive = false;
        even.timeLimit = 0; // nor the size of its pilots, which a render's clock may lessen
        PlanFilm film(like, scene.frame);
        return RenderJob(kernel_, scene, film, even, {}).lightPaths();
    }

  private:
    const Kernel& kernel_;
};

} // namespace

std::unique_ptr<const Integrator> makePathTracer(Effects required) {
    for (const Kernel& kernel : kKernels)
        if (kernel.effects.contains(required & kLoopEffects)) return std::make_unique<PathTracer>(kernel);
    return std::make_unique<PathTracer>(std::end(kKernels)[-1]);
}

} // namespace abbe

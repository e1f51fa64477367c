#include "rendering/path_tracer.h"

#include "base/check.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "light_sampling/light_sampler.h"
#include "path_tracing/path_kernels.h"
#include "render/film.h"
#include "render/render_state.h"
#include "render/scene.h"
#include "rendering/look_ahead.h"
#include "rendering/render_plans.h"
#include "rendering/shared_tile.h"
#include "rendering/time_left.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

namespace abbe {

namespace {

// At most about this long is a tile in one thread's hands, so that a render ends soon when it is told to.
constexpr double kPortionSeconds = 0.4;
// s: a portion that is predicted to go on for longer than this after the time limit is not begun, and what goes on then
// is cut short.
constexpr double kOvertime = 0.1;

bool drawsChoices(const Scene& scene, const LightSampler& lights, const Technique& technique) {
    return lights.needsChoice() || technique.directions != Technique::Directions::importance ||
           scene.camera->usesLens() ||
           std::any_of(scene.materials.begin(), scene.materials.end(), [](const auto& m) { return m->choosesLobe(); });
}

// Whether scattering finds even skies as well as light samples do. Not where hardly any ray gets out to them, when a
// second way to try is worth more than picks of other lights; nor where shadow rays pass what stops others.
bool leavesEvenSkies(const Scene& scene, const Film& film, const Technique& technique) {
    constexpr float kOpen = 0.25f; // docs/decisions/038-even-skies.md
    if (technique.strategy != Technique::Strategy::mis || scene.hidden.splits) return false;
    if (std::ranges::none_of(scene.lights, [](const auto& light) { return light->output().even; })) return false;
    return openness(scene, scene.frame.area() > 0 ? scene.frame : film.bounds()) > kOpen;
}

// One render from the first pass to the last: owns the schedule, the statistics and the talk with the caller.
class RenderJob {
  public:
    RenderJob(const Kernel& kernel, const Scene& scene, Film& film, const RenderSettings& settings,
              const RenderControl& control)
        : kernel_(kernel), film_(film), settings_(settings), control_(control),
          watch_(control.stop, settings.timeLimit > 0 ? settings.timeLimit + kOvertime : 0),
          lights_(scene.lights, settings.technique.lightChoice, watch_.over(),
                  leavesEvenSkies(scene, film, settings.technique)),
          context_{scene, lights_, settings, drawsChoices(scene, lights_, settings.technique),
                   settings.samplesPerReplicate(film.replicates())},
          range_(settings.range(film.replicates())), ownState_(ownState(scene, film, settings, control)),
          state_(control.state ? *control.state : *ownState_), pass_(passesBefore(state_.reached())) {
        statistics_.kernel = kernel.name;
        context_.stop = &watch_.over();
        statistics_.add(state_.tally());
    }

    RenderStatistics run() {
        plan(context_);
        beginTiming();
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

    CausticFindings caustics() {
        plan(context_);
        return statistics_.caustics;
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
        plans_ =
            planRender({context, kernel_.render, kernel_.lightPaths, film_, state_, control_.framePreview, left, stop});
        statistics_.caustics = plans_.findings;
        statistics_.pilotRays = plans_.rays;
        statistics_.pilotSeconds = plans_.seconds;
        statistics_.pilotCoreSeconds = plans_.coreSeconds;
        statistics_.look = plans_.ahead.findings(context_.scene);
        plans_.ahead.giveTo(context_);
        plans_.caustics.giveTo(context_);
        guideBy(plans_.guide.get(), context_);
        if (plans_.caustics.any()) render_ = kernel_.lightPaths.render;
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
    // Without a sample there is nothing to show or to keep yet.
    bool snapshotRequested() const {
        return control_.snapshot && begun_ && control_.snapshot->load(std::memory_order_relaxed);
    }
    double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    bool stopRequested() const {
        if (control_.stop && control_.stop->load(std::memory_order_relaxed)) return true;
        return isTimed() && timeLeft() < 0;
    }
    double timeLeft() const { return settings_.timeLimit - elapsed(); } // s, if there is a limit
    bool isTimed() const { return settings_.timeLimit > 0; }
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
        return isTimed() && reached == state_.first() ? reached + 1 : endOfPassWith(reached);
    }

    // All tiles up to sample `last`, as far as nobody ends it.
    void runPass(std::uint32_t last) {
        std::vector<std::size_t> open;
        for (std::size_t i = 0; i < state_.tileCount(); ++i)
            if (state_.tile(i).reached < last) open.push_back(i);
        // In this order: a picture that is ended before its first light paths would lack all of their light. Of tiles
        // the dearest go first, or one of them would be begun last, and all threads but one wait for it [Graham1969].
        const auto tiles =
            std::ranges::stable_partition(open, [this](std::size_t i) { return state_.isLightBlock(i); });
        std::ranges::stable_sort(tiles, std::greater(),
                                 [this](std::size_t i) { return state_.tile(i).tally.coreSeconds; });
        dear_ = leastOfDear();
        bool goesOn = true; // else what is left of the pass would end after the time limit
        do {
            advanced_ = false;
            std::atomic<std::size_t> next = 0;
            parallelFor(open.size(), [&](std::size_t) { advance(open[next++], last); });
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
            const void* cappedIn = nullptr;
            const std::uint32_t first = tile.reached;
            {
                const auto hold = state_.hold(i);
                const std::uint32_t end = tile.cut ? tile.cut->end : std::min(last, tile.reached + portion(tile));
                if (end == tile.reached) return;
                advanced_ = true;
                const double before = threadSeconds();
                const TileResult result = work(i, {end, tile.cut ? tile.cut->at : PortionPlace()});
                tally = tallyOf(result, threadSeconds() - before + result.secondsElsewhere);
                chains = result.counters.manifold;
                cappedIn = result.counters.cappedIn;
                tile.tally.add(tally);
                tile.cut = result.rest ? std::optional(CutPortion{end, *result.rest}) : std::nullopt;
                if (!tile.cut) tile.reached = end;
                if (!state_.isLightBlock(i)) begun_ = true;
                for (const DroppedSample& s : result.examples)
                    if (tile.examples.size() < TileState::kExamples) tile.examples.push_back(s);
            }
            const std::lock_guard lock(mutex_);
            statistics_.add(tally);
            statistics_.manifoldEstimates += chains.estimates;
            statistics_.manifoldTrials += chains.trials;
            statistics_.manifoldCapped += chains.capped;
            if (cappedIn) statistics_.cappedIn[cappedIn] += tally.cappedPaths;
            timeLeft_->advanced(i, tile.reached - first, tally.coreSeconds);
            pixelSamples_ += state_.pixels(i).area() * (tile.reached - first);
            maybeReport();
        }
    }

    // A portion of the samples of a tile, from where it was cut short, if it was.
    TileResult work(std::size_t i, const CutPortion& portion) {
        const std::uint32_t first = state_.tile(i).reached;
        if (state_.isLightBlock(i))
            return plans_.caustics.render(context_, kernel_.lightPaths, film_,
                                          {first, portion.end, static_cast<std::uint32_t>(state_.lightBlock(i)),
                                           static_cast<std::uint32_t>(state_.lightBlockCount()), portion.at});
        const TileJob job{state_.pixels(i), first, portion.end, &plans_.ahead.roulette, samplePlan(), portion.at};
        return isDear(i) ? renderShared(render_, context_, film_, job) : render_(context_, film_, job);
    }

    // Whether a tile takes so much of a pass that threads would wait for it at the end.
    bool isDear(std::size_t i) const { return dear_ > 0 && state_.tile(i).tally.coreSeconds > dear_; }
    // Core seconds so far from which on a tile is dear; 0: none is. With two threads few are.
    double leastOfDear() const {
        constexpr double kPerThread = 4;
        if (threadCount() < 2 || film_.makeRecorder()) return 0; // recorders see a tile's samples in their order
        double all = 0;
        for (std::size_t i = 0; i < state_.tileCount(); ++i) all += state_.tile(i).tally.coreSeconds;
        return all / (kPerThread * threadCount());
    }

    const SamplingPlan* samplePlan() const { return plans_.ahead.plan.even() ? nullptr : &plans_.ahead.plan; }

    // How many samples of each replicate are taken in one go; none if even one would end after the time limit.
    std::uint32_t portion(const TileState& tile) const {
        const std::uint32_t done = tile.reached - state_.first();
        if (done == 0) return isTimed() ? 1 : 2;
        const double each = std::max(tile.tally.coreSeconds, 1e-6) / done;
        double seconds = kPortionSeconds;
        if (isTimed()) {
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
        const TimeLeft::Forecast forecast = timeLeft_->at(p.elapsed);
        p.fraction = std::max(least, forecast.fraction);
        p.left = least < 1 ? forecast.left : 0;
        control_.progress(p);
    }

    const Kernel& kernel_;
    Film& film_;
    RenderSettings settings_;
    const RenderControl& control_;
    const Clock::time_point start_ = Clock::now();
    EndWatch watch_;
    LightSampler lights_;
    PathContext context_;
    RenderPlans plans_;
    TileFunction render_ = kernel_.render; // of pixels
    SampleRange range_;
    std::optional<RenderState> ownState_; // unless the caller has one
    RenderState& state_;
    std::uint32_t pass_ = 0;
    double dear_ = 0; // leastOfDear() of this pass
    RenderStatistics statistics_;
    std::optional<TimeLeft> timeLeft_; // from the first sample on
    std::int64_t pixelSamples_ = 0;    // of each replicate, in all pixels, as if they were even
    std::mutex mutex_;
    double lastReport_ = 0;
    std::uint64_t pathsBefore_ = state_.tally().paths; // of earlier runs
    bool unfinished_ = false;                          // the last pass was cut short
    std::atomic<bool> advanced_ = false;               // any tile, since asked last
    std::atomic<bool> begun_ = !state_.empty();        // any sample of a pixel
};

// For plans of a render that is not made: the whole frame with the pixel filter of another film; takes all light and
// keeps none.
class PlanFilm final : public FilmDecorator {
  public:
    PlanFilm(const Film& like, PixelBounds frame) : FilmDecorator(like), frame_(frame) {}
    PixelBounds bounds() const override { return frame_; }
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    bool takesSplats() const override { return true; }
    bool takesMerged() const override { return true; }

  private:
    PixelBounds frame_;
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
    CausticFindings findCaustics(const Scene& scene, const Film& like, const RenderSettings& settings) const override {
        CausticFindings known;
        known.of<LightPathFindings>().verdict = lightPathVerdict(scene, settings.technique);
        if (lightBlocks(scene, settings) == 0) return known;
        RenderSettings even = settings; // a plan of the samples changes nothing
        even.adaptive = false;
        even.timeLimit = 0; // nor the size of its pilots, which a render's clock may lessen
        PlanFilm film(like, scene.frame);
        return RenderJob(kernel_, scene, film, even, {}).caustics();
    }

  private:
    const Kernel& kernel_;
};

} // namespace

std::unique_ptr<const Integrator> makePathTracer(Effects required) {
    return std::make_unique<PathTracer>(kernelFor(required));
}

} // namespace abbe

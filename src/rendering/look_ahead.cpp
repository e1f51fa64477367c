#include "rendering/look_ahead.h"

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/work.h"
#include "render/render_state.h"
#include "render/scene.h"
#include "rendering/endless_paths.h"

#include <atomic>
#include <numeric>

namespace abbe {

namespace {

constexpr std::uint64_t kPilot = 0x70696c6f74; // "pilot"
constexpr std::uint64_t kPlan = 0x706c616e;    // "plan"
// Without roulette paths that carry less than a millionth are ended, with a probability that they make up for: in a
// scene that absorbs nearly everything they would go on to no end.
constexpr float kNoRoulette = 1e6f;

class Looker {
  public:
    Looker(const PathContext& context, TileFunction render, const Film& film, const std::function<bool()>& stop)
        : context_(context), render_(render), film_(film), stop_(stop),
          frame_(context.scene.frame.area() > 0 ? context.scene.frame : film.bounds()) {}

    LookAhead run(const RenderState& state) {
        const Technique::Roulette roulette = context_.settings.technique.roulette;
        if (roulette == Technique::Roulette::throughput) result_.roulette = RouletteReference::constant(1);
        if (roulette == Technique::Roulette::off) result_.roulette = RouletteReference::constant(kNoRoulette);
        const Stopwatch watch;
        PilotFilm pilot = look();
        describe(pilot, watch.seconds());
        if (roulette == Technique::Roulette::pilot) result_.roulette = RouletteReference(pilot);
        if (context_.settings.adaptive && !stop_()) result_.plan = plan();
        for (std::size_t i = 0; i < state.pixelTileCount(); ++i) {
            const PixelBounds pixels = state.pixels(i);
            result_.tileCosts.push_back((1 + pilot.rays(pixels)) * result_.plan.meanFactor(pixels));
        }
        // The pilot says nothing about light paths: as a tile, until there are measured ones.
        const std::vector<double>& costs = result_.tileCosts;
        const double mean = std::accumulate(costs.begin(), costs.end(), 0.0) / static_cast<double>(costs.size());
        result_.tileCosts.resize(state.tileCount(), mean);
        result_.rays = rays_;
        return std::move(result_);
    }

  private:
    PathContext reseeded(std::uint64_t key) const {
        PathContext context = context_;
        context.settings.seed = combine64(context_.settings.seed, key);
        return context;
    }

    // The number of rays.
    std::uint64_t trace(const PathContext& context, Film& film, PixelBounds pixel, std::uint32_t samples) {
        addWorkFlag(WorkFlag::pilot);
        const PathCounters c = render_(context, film, {pixel, 0, samples, &result_.roulette}).counters;
        removeWorkFlag(WorkFlag::pilot);
        rays_ += c.vertices + c.shadowRays;
        return c.vertices + c.shadowRays;
    }

    PilotFilm look() {
        const PathContext context = reseeded(kPilot);
        PilotFilm pilot(frame_, context.settings.seed);
        parallelFor(static_cast<std::size_t>(pilot.rows()), [&](std::size_t i) {
            const int row = static_cast<int>(i);
            for (int column = 0; column < pilot.columns() && !stop_(); ++column)
                pilot.noteRays(column, row, trace(context, pilot, pilot.pixelOf(column, row), PilotFilm::kSamples));
        });
        return pilot;
    }

    // Those that there was no time for look as the others do in the mean. None if nothing was seen.
    static std::vector<Xyz> cellsOf(const PilotFilm& pilot) {
        std::vector<Xyz> cells;
        std::vector<std::size_t> unseen;
        Xyz sum;
        for (int row = 0; row < pilot.rows(); ++row)
            for (int column = 0; column < pilot.columns(); ++column) {
                if (!pilot.seen(column, row)) unseen.push_back(cells.size());
                const PixelBounds pixel = pilot.pixelOf(column, row);
                cells.push_back(pilot.mean(pixel.x0, pixel.y0));
                sum += cells.back();
            }
        if (unseen.size() == cells.size()) return {};
        const Xyz mean = sum * (1 / static_cast<double>(cells.size() - unseen.size()));
        for (const std::size_t i : unseen) cells[i] = mean;
        return cells;
    }

    void describe(const PilotFilm& pilot, double seconds) {
        FirstLook& first = result_.first;
        first = {frame_, pilot.cellSize(), pilot.columns(), pilot.rows(), {}, 0, 0, {}};
        first.cells = cellsOf(pilot);
        const double paths = static_cast<double>(pilot.columns()) * pilot.rows() * PilotFilm::kSamples;
        first.secondsForSample = seconds / paths * static_cast<double>(frame_.area());
        result_.raysOfPath = first.raysOfPath = static_cast<double>(rays_) / paths;
        if (result_.raysOfPath > kManyRays && !stop_())
            first.endless = findEndlessPaths(reseeded(kPilot), render_, pilot, result_.roulette);
    }

    // With the roulette of the image.
    SamplingPlan plan() {
        const PathContext base = reseeded(kPlan);
        std::vector<PathContext> contexts(PlanPilot::kLooks, base); // so that no two looks share a sample
        for (std::size_t look = 0; look < contexts.size(); ++look)
            contexts[look].settings.seed = combine64(base.settings.seed, look);
        PlanPilot pilot(frame_, base.settings.seed);
        parallelFor(static_cast<std::size_t>(pilot.rows()), [&](std::size_t i) {
            const int row = static_cast<int>(i);
            for (int column = 0; column < pilot.columns() && !stop_(); ++column)
                for (int look = 0; look < PlanPilot::kLooks; ++look) {
                    const PixelBounds pixel = pilot.pixelOf(column, row, look);
                    PlanPilot::Probe probe(pixel, film_);
                    const auto rays =
                        trace(contexts[static_cast<std::size_t>(look)], probe, pixel, PlanPilot::kSamples);
                    pilot.add(column, row, look, probe, rays);
                }
        });
        return SamplingPlan(pilot);
    }

    const PathContext& context_;
    TileFunction render_;
    const Film& film_;
    const std::function<bool()>& stop_;
    PixelBounds frame_;
    std::atomic<std::uint64_t> rays_{0};
    LookAhead result_;
};

} // namespace

LookAhead lookAhead(const PathContext& context, TileFunction render, const Film& film, const RenderState& state,
                    const std::function<bool()>& stop) {
    return Looker(context, render, film, stop).run(state);
}

} // namespace abbe

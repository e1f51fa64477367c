#include "rendering/look_ahead.h"

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/work.h"
#include "light_sampling/light_sampler.h"
#include "math/hash.h"
#include "math/warp.h"
#include "render/camera.h"
#include "render/film.h"
#include "render/material.h"
#include "render/path_observer.h"
#include "render/render_state.h"
#include "render/scene.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <numeric>

namespace abbe {

namespace {

constexpr std::size_t kLookedAtCells = 16, kNamedShapes = 4;
constexpr float kLossless = 0.9995f; // weight of a scattering that takes nothing away
constexpr double kMostly = 0.9;      // of the scatterings of long paths
constexpr double kWorthNaming = 0.1; // likewise, of one shape

struct LongScatterings {
    std::uint64_t paths = 0, longPaths = 0, all = 0;
    std::map<const Shape*, std::uint64_t> lossless;

    void add(const LongScatterings& s) {
        paths += s.paths;
        longPaths += s.longPaths;
        all += s.all;
        for (const auto& [shape, count] : s.lossless) lossless[shape] += count;
    }
};

// Counts what happens to paths that are long.
class LongPathRecorder final : public SampleRecorder {
  public:
    explicit LongPathRecorder(LongScatterings& to) : to_(to) {}

    void pixel(int, int, int) noexcept override {}
    void start(const Ray&, const Wavelengths&) noexcept override {
        ++to_.paths;
        vertex_ = 0;
    }
    void arrives(const SurfaceHit&, const Spectrum&) noexcept override { count(); }
    void collides(Vec3, const Spectrum&) noexcept override {
        count();
        to_.all += isLong();
    }
    void scatters(const SurfaceHit& hit, Lobes, const Spectrum&, const BsdfSample* next) noexcept override {
        if (!isLong()) return;
        ++to_.all;
        if (next && mean(next->weight) >= kLossless) ++to_.lossless[hit.shape];
    }
    void gathers(const Spectrum&, const void*, bool) noexcept override {}
    void keep(const Spectrum&, const Sensor&, double) noexcept override {}
    void drop() noexcept override {}
    void pixelDone(double) noexcept override {}

  private:
    bool isLong() const { return vertex_ > kLongPath; }
    void count() { to_.longPaths += ++vertex_ == kLongPath + 1; }

    LongScatterings& to_;
    std::uint32_t vertex_ = 0;
};

// Keeps no light.
class ListeningFilm final : public FilmDecorator {
  public:
    explicit ListeningFilm(const Film& like) : FilmDecorator(like) {}
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    std::unique_ptr<SampleRecorder> makeRecorder() override { return std::make_unique<LongPathRecorder>(heard); }

    LongScatterings heard;
};

std::vector<PixelBounds> dearestPixels(const PilotFilm& pilot) {
    std::vector<PixelBounds> pixels;
    for (int row = 0; row < pilot.rows(); ++row)
        for (int column = 0; column < pilot.columns(); ++column) pixels.push_back(pilot.pixelOf(column, row));
    const auto end = pixels.begin() + static_cast<std::ptrdiff_t>(std::min(pixels.size(), kLookedAtCells));
    std::partial_sort(pixels.begin(), end, pixels.end(),
                      [&](PixelBounds a, PixelBounds b) { return pilot.rays(a) > pilot.rays(b); });
    pixels.erase(end, pixels.end());
    return pixels;
}

EndlessPaths judge(const LongScatterings& heard) {
    std::vector<std::pair<std::uint64_t, const Shape*>> shapes;
    std::uint64_t lossless = 0;
    for (const auto& [shape, count] : heard.lossless) {
        lossless += count;
        shapes.emplace_back(count, shape);
    }
    EndlessPaths found;
    const auto all = static_cast<double>(heard.all);
    if (heard.all == 0 || static_cast<double>(lossless) < kMostly * all) return found;
    std::ranges::stable_sort(shapes, std::greater{}, [](const auto& s) { return s.first; });
    for (const auto& [count, shape] : shapes)
        if (found.shapes.size() < kNamedShapes && static_cast<double>(count) >= kWorthNaming * all)
            found.shapes.push_back(shape);
    found.share = static_cast<double>(heard.longPaths) / static_cast<double>(heard.paths);
    return found;
}

} // namespace

namespace {

// Goes on to the next surface, through boundaries of media.
bool meetsSurface(const Scene& scene, Ray& ray, SurfaceHit& hit) {
    constexpr int kMostBoundaries = 64;
    for (int i = 0; i < kMostBoundaries; ++i) {
        if (!scene.intersector->intersect(ray, hit)) return false;
        if (!hit.material || !hit.material->isBoundary()) return true;
        ray.origin = spawnOrigin(hit, ray.direction);
    }
    return true;
}

} // namespace

float openness(const Scene& scene, PixelBounds frame) {
    constexpr std::uint64_t kLooks = 1024;
    int seen = 0, open = 0;
    for (std::uint64_t i = 0; i < kLooks; ++i) {
        RandomStream random(mix64(i));
        const auto along = [&](int first, int size) {
            return static_cast<float>(first) + random.uniform() * static_cast<float>(size);
        };
        CameraSample at;
        at.film.x = along(frame.x0, frame.width());
        at.film.y = along(frame.y0, frame.height());
        at.lens = {0.5f, 0.5f};
        CameraRay camera = scene.camera->ray(at);
        SurfaceHit hit;
        if (!(camera.weight > 0) || !meetsSurface(scene, camera.ray, hit)) continue;
        const Vec3 n = dot(hit.ng, camera.ray.direction) > 0 ? -hit.ng : hit.ng;
        const float u = random.uniform(), v = random.uniform();
        const Vec3 w = Frame::fromNormal(n).toWorld(squareToCosineHemisphere({u, v}));
        Ray out{spawnOrigin(hit, w), w};
        ++seen;
        open += !meetsSurface(scene, out, hit);
    }
    return seen > 0 ? static_cast<float>(open) / static_cast<float>(seen) : 1;
}

EndlessPaths findEndlessPaths(const PathContext& context, TileFunction render, const PilotFilm& pilot,
                              const RouletteReference& roulette) {
    const std::vector<PixelBounds> pixels = dearestPixels(pilot);
    LongScatterings heard;
    std::mutex mutex;
    parallelFor(pixels.size(), [&](std::size_t i) {
        ListeningFilm film(pilot);
        addWorkFlag(WorkFlag::pilot);
        render(context, film, {pixels[i], 0, PilotFilm::kSamples, &roulette});
        removeWorkFlag(WorkFlag::pilot);
        const std::lock_guard lock(mutex);
        heard.add(film.heard);
    });
    return judge(heard);
}

namespace {

constexpr std::uint64_t kPilot = 0x70696c6f74; // "pilot"
constexpr std::uint64_t kPlan = 0x706c616e;    // "plan"
// Without roulette paths that carry less than a millionth are ended, with a probability that they make up for: in a
// scene that absorbs nearly everything they would go on to no end.
constexpr float kNoRoulette = 1e6f;

// Who listens to the first look at a frame.
struct Listeners {
    WalkPilot walks;
    LightPilot lights;
};

// Passes on what the two listen to, and nothing else.
class TeeRecorder final : public SampleRecorder {
  public:
    void add(std::unique_ptr<SampleRecorder> to) { to_.push_back(std::move(to)); }

    void pixel(int x, int y, int r) noexcept override { tell(&SampleRecorder::pixel, x, y, r); }
    void start(const Ray& ray, const Wavelengths& w) noexcept override { tell(&SampleRecorder::start, ray, w); }
    void keep(const Spectrum& s, const Sensor& sensor, double factor) noexcept override {
        for (const auto& r : to_) r->keep(s, sensor, factor);
    }
    void drop() noexcept override { tell(&SampleRecorder::drop); }
    void pixelDone(double seconds) noexcept override { tell(&SampleRecorder::pixelDone, seconds); }
    void arrives(const SurfaceHit& hit, const Spectrum& beta) noexcept override {
        tell(&SampleRecorder::arrives, hit, beta);
    }
    void collides(Vec3 p, const Spectrum& beta) noexcept override { tell(&SampleRecorder::collides, p, beta); }
    void walked(const Medium& medium, float likelihood) noexcept override {
        tell(&SampleRecorder::walked, medium, likelihood);
    }
    void scatters(const SurfaceHit&, Lobes, const Spectrum&, const BsdfSample*) noexcept override {}
    void asks(const Receiver& at, const Light* light, std::uint32_t part) noexcept override {
        tell(&SampleRecorder::asks, at, light, part);
    }
    void samples(const void* source, const LightSample& light, const BsdfEval& eval, float pdf) noexcept override {
        tell(&SampleRecorder::samples, source, light, eval, pdf);
    }
    void gathers(const Spectrum& light, const void* source, bool passing) noexcept override {
        tell(&SampleRecorder::gathers, light, source, passing);
    }

  private:
    template <typename Event, typename... Args> void tell(Event event, const Args&... args) noexcept {
        for (const auto& recorder : to_) ((*recorder).*event)(args...);
    }
    std::vector<std::unique_ptr<SampleRecorder>> to_;
};

// The film, and who listens of those for whom there is anything to hear.
class HeardFilm final : public FilmDecorator {
  public:
    HeardFilm(const PathContext& context, Film& film, Listeners& to)
        : FilmDecorator(film), film_(film), to_(to), walks_(WalkPilot::wanted(context.scene)),
          lights_(asksAtSurfaces(context)) {}

    bool listens() const { return walks_ || lights_; }
    void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        film_.add(x, y, replicate, sum, samples);
    }
    std::unique_ptr<SampleRecorder> makeRecorder() override {
        auto all = std::make_unique<TeeRecorder>();
        if (walks_) all->add(to_.walks.recorder());
        if (lights_) all->add(to_.lights.recorder());
        return all;
    }

  private:
    // For one of several lights, and nowhere in media: of those nothing is learnt, and most of the light may be theirs.
    static bool asksAtSurfaces(const PathContext& context) {
        const auto isLit = [](const MediumUse& m) { return m.lit && m.place != MediumUse::Place::nowhere; };
        return context.settings.technique.lightChoice == Technique::LightChoice::tree && context.how.nextEvent &&
               context.lights.hasGroups() && std::ranges::none_of(context.scene.mediumUses, isLit);
    }

    Film& film_;
    Listeners& to_;
    bool walks_, lights_;
};

class FramePilot {
  public:
    FramePilot(const PathContext& context, TileFunction render, const Film& film, const std::function<bool()>& stop)
        : context_(context), render_(render), film_(film), stop_(stop),
          frame_(context.scene.frame.area() > 0 ? context.scene.frame : film.bounds()) {}

    LookAhead run(const RenderState& state) {
        const Technique::Roulette roulette = context_.settings.technique.roulette;
        if (roulette == Technique::Roulette::throughput) result_.roulette = RouletteReference::constant(1);
        if (roulette == Technique::Roulette::off) result_.roulette = RouletteReference::constant(kNoRoulette);
        const Stopwatch watch;
        Listeners heard;
        PilotFilm pilot = look(heard);
        describe(pilot, watch.seconds());
        const RouletteReference shown(pilot);
        if (roulette == Technique::Roulette::pilot) result_.roulette = shown;
        result_.pulled = heard.walks.shares(context_.scene, shown);
        result_.arrival = heard.lights.learn(context_.lights, [&](int x, int y) { return shown.scale(x, y); });
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
        result_.giveTo(context);
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

    PilotFilm look(Listeners& to) {
        const PathContext context = reseeded(kPilot);
        PilotFilm pilot(frame_, context.settings.seed);
        HeardFilm heard(context, pilot, to);
        Film& film = heard.listens() ? static_cast<Film&>(heard) : pilot;
        parallelFor(static_cast<std::size_t>(pilot.rows()), [&](std::size_t i) {
            const int row = static_cast<int>(i);
            for (int column = 0; column < pilot.columns() && !stop_(); ++column)
                pilot.noteRays(column, row, trace(context, film, pilot.pixelOf(column, row), PilotFilm::kSamples));
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
        FramePreview& first = result_.first;
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

LookFindings LookAhead::findings(const Scene& scene) const {
    LookFindings found{.lightsByArrival = arrival.has_value()};
    for (const auto& medium : scene.media)
        if (WalkPilot::serves(scene, *medium))
            found.walks.emplace_back(scene.mediumUses[medium->number].name, pulled.of(*medium));
    return found;
}

LookAhead lookAhead(const PathContext& context, TileFunction render, const Film& film, const RenderState& state,
                    const std::function<bool()>& stop) {
    return FramePilot(context, render, film, stop).run(state);
}

} // namespace abbe

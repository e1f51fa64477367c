// How efficient light paths could be in the spot of bench_caustic if all but their rays cost nothing.
//   bench_caustic_bound [--size N] [--seconds N] [--way PROPERTIES] [RADIUS…]
//     default: 48, 10, 'light-paths alone', 0.5 0.1
// Of N independent paths, each of which meets pixel i with probability p_i, the best estimate has a relative variance
// of 1 / (N p_i) in that pixel, less what is negligible; in the mean over the P pixels of the spot that is at least P /
// (N Σ p_i) (arithmetic and harmonic mean). So the efficiency, 1 / (relMSE × core-seconds), is at most
//     (paths a second) × (splats in the spot for each path) / P.
// Paths a second are those that tracing their rays alone allows: rays are kept while light paths are followed, then
// traced again, in the same order and by the same intersector. "least" is by asking whether anything lies on the ray at
// all, which finds no nearest hit and nothing about it. "ideal" is with that and with paths that all bring one splat,
// for four rays: to the ball, through it, to the floor, and to the lens.
#include "ball_spot.h"
#include "base/parallel.h"
#include "base/work.h"
#include "film/film_params.h"
#include "measure.h"

#include <cstdio>
#include <cstring>

using namespace abbe;

namespace {

constexpr std::size_t kMostRays = 4'000'000; // that are kept
constexpr double kIdealRays = 4;

struct KeptRay {
    Ray ray;
    bool nearest = true; // what was asked: the nearest hit, or whether there is any
};

// Stands before another intersector and keeps the rays of light paths, but not those of pilots. For one thread.
class KeepingIntersector final : public Intersector {
  public:
    KeepingIntersector(std::unique_ptr<const Intersector> inner, std::vector<KeptRay>& rays)
        : inner_(std::move(inner)), rays_(rays) {
        rays_.reserve(kMostRays);
    }

    const Intersector& inner() const { return *inner_; }

    bool intersect(const Ray& ray, SurfaceHit& hit) const noexcept override {
        keep({ray, true});
        return inner_->intersect(ray, hit);
    }
    std::size_t coincident(const Ray& ray, const SurfaceHit& hit,
                           std::span<SurfaceHit> others) const noexcept override {
        return inner_->coincident(ray, hit, others);
    }
    std::optional<Passage> passage(const Ray& ray, const SurfaceHit& hit, float distance) const noexcept override {
        return inner_->passage(ray, hit, distance);
    }
    bool occluded(const Ray& ray) const noexcept override {
        keep({ray, false});
        return inner_->occluded(ray);
    }
    bool occluded(Vec3 from, Vec3 to, float time) const noexcept override {
        const float distance = length(to - from);
        keep({{from, (to - from) / distance, distance, time}, false});
        return inner_->occluded(from, to, time);
    }
    Bounds3 bounds() const override { return inner_->bounds(); }
    std::uint64_t rejectedRays() const override { return inner_->rejectedRays(); }

  private:
    void keep(const KeptRay& ray) const noexcept {
        constexpr auto kLight = static_cast<unsigned>(WorkFlag::light), kPilot = static_cast<unsigned>(WorkFlag::pilot);
        const unsigned flags = workState.flags.load(std::memory_order_relaxed);
        if ((flags & kLight) && !(flags & kPilot) && rays_.size() < kMostRays) rays_.push_back(ray);
    }

    std::unique_ptr<const Intersector> inner_;
    std::vector<KeptRay>& rays_;
};

// Counts what light paths bring to a spot.
class CountingFilm final : public Film {
  public:
    CountingFilm(PixelFilm& film, const BallSpot& spot) : film_(film), spot_(spot) {}

    std::uint64_t inSpot() const { return inSpot_; }
    std::uint64_t lightPaths() const { return lightPaths_; }

    PixelBounds bounds() const override { return film_.bounds(); }
    int replicates() const override { return film_.replicates(); }
    FilterSample filter(Vec2 u) const noexcept override { return film_.filter(u); }
    float filterRadius() const noexcept override { return film_.filterRadius(); }
    float filterWeight(float offset) const noexcept override { return film_.filterWeight(offset); }
    void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override {
        film_.add(x, y, replicate, sum, samples);
    }
    Xyz mean(int x, int y) const noexcept override { return film_.mean(x, y); }
    double relativeNoise() const override { return film_.relativeNoise(); }
    bool takesSplats() const override { return film_.takesSplats(); }
    void splat(int x, int y, int replicate, const Splat& splat) noexcept override {
        inSpot_ += spot_.contains(static_cast<std::size_t>(y * bounds().width() + x));
        film_.splat(x, y, replicate, splat);
    }
    void countLightPaths(int replicate, std::uint64_t paths) noexcept override {
        lightPaths_ += paths;
        film_.countLightPaths(replicate, paths);
    }

  private:
    PixelFilm& film_;
    const BallSpot& spot_;
    std::uint64_t inSpot_ = 0, lightPaths_ = 0;
};

struct Options {
    int size = 48;
    double seconds = 10;
    std::string way = "light-paths alone";
    std::vector<double> radii;
};

// Of a path that starts at the lamp.
struct LightPathCost {
    double rays = 0, share = 0;         // share: splats in the spot
    double seconds = 0, anySeconds = 0; // of a ray by itself; any: whether there is anything
};

// Seconds for each ray: the least of five rounds over all of them.
template <typename Trace> double secondsOf(const std::vector<KeptRay>& rays, Trace trace) {
    double least = 1e30;
    std::size_t found = 0;
    for (int i = 0; i < 5; ++i) {
        const double start = seconds(CLOCK_THREAD_CPUTIME_ID);
        for (const KeptRay& ray : rays) found += trace(ray);
        least = std::min(least, seconds(CLOCK_THREAD_CPUTIME_ID) - start);
    }
    if (found == 0) throw std::runtime_error("no ray met anything");
    return least / static_cast<double>(rays.size());
}

LightPathCost costOf(const BallSpot& spot, const Options& o) {
    std::vector<KeptRay> rays;
    test::TestScene scene = spot.scene(o.way);
    auto keeping = std::make_unique<KeepingIntersector>(std::move(scene.changeable().intersector), rays);
    const Intersector& inner = keeping->inner();
    scene.changeable().intersector = std::move(keeping);
    const FilmSettings settings = filmSettings(scene.built().film);
    PixelFilm film(settings.crop, PixelFilter(settings.filter, settings.filterRadius), 1);
    CountingFilm counting(film, spot);
    RenderSettings how = scene.settings();
    how.samples = 16;
    const auto integrator = makePathTracer(scene.scene().effects);
    film.keepSplatsOf(*integrator, scene.scene(), how);
    integrator->render(scene.scene(), counting, how, {});
    if (counting.lightPaths() == 0) throw std::runtime_error("no light paths");
    if (rays.size() == kMostRays) throw std::runtime_error("more rays than are kept");
    LightPathCost cost;
    const auto paths = static_cast<double>(counting.lightPaths());
    cost.rays = static_cast<double>(rays.size()) / paths;
    cost.share = static_cast<double>(counting.inSpot()) / paths;
    SurfaceHit hit;
    cost.seconds = secondsOf(
        rays, [&](const KeptRay& r) { return r.nearest ? inner.intersect(r.ray, hit) : inner.occluded(r.ray); });
    cost.anySeconds = secondsOf(rays, [&](const KeptRay& r) { return inner.occluded(r.ray); });
    return cost;
}

struct Efficiency {
    double value = 0, relMse = 0, lightPaths = 0; // of one render
};

Efficiency measured(const BallSpot& spot, const std::string& way, double wanted) {
    const test::TestScene scene = spot.scene(way);
    const MeasuredRender trial = BallSpot::render(scene.built(), 64, 7);
    const auto samples = static_cast<std::uint32_t>(std::max(1.0, 64 * wanted / trial.statistics.coreSeconds));
    const MeasuredRender a = BallSpot::render(scene.built(), samples, 1),
                         b = BallSpot::render(scene.built(), samples, 2);
    const double relMse = spot.error(a, b).relMse;
    return {2 / (relMse * (a.statistics.coreSeconds + b.statistics.coreSeconds)), relMse,
            static_cast<double>(a.statistics.lightPaths)};
}

void run(const Options& o) {
    for (const double radius : o.radii) {
        const BallSpot spot(radius, o.size);
        const auto pixels = static_cast<double>(spot.area());
        const LightPathCost cost = costOf(spot, o);
        const Efficiency camera = measured(spot, "light-paths off", o.seconds),
                         light = measured(spot, o.way, o.seconds);
        std::printf("lamp of radius %g, spot of %.0f pixels\n", radius, pixels);
        std::printf("  a light path: %.2f rays, %.3f splats in the spot; a ray %.0f ns, at least %.0f ns\n", cost.rays,
                    cost.share, 1e9 * cost.seconds, 1e9 * cost.anySeconds);
        std::printf("  camera paths: efficiency %.3g\n", camera.value);
        std::printf("  %s: efficiency %.3g, ×%.3g; relMSE %.3g, of independent splats at least %.3g\n", o.way.c_str(),
                    light.value, light.value / camera.value, light.relMse, pixels / (light.lightPaths * cost.share));
        const auto bound = [&](const char* name, double perSecond, double share) {
            const double efficiency = perSecond * share / pixels;
            std::printf("  bound, %-6s %.3g million paths/s: efficiency %.4g, ×%.4g\n", name, 1e-6 * perSecond,
                        efficiency, efficiency / camera.value);
        };
        bound("rays", 1 / (cost.rays * cost.seconds), cost.share);
        bound("least", 1 / (cost.rays * cost.anySeconds), cost.share);
        bound("ideal", 1 / (kIdealRays * cost.anySeconds), 1);
        std::fflush(stdout);
    }
}

Options read(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const auto next = [&] { return ++i < argc ? argv[i] : ""; };
        if (!std::strcmp(argv[i], "--size"))
            o.size = std::max(1, std::atoi(next()));
        else if (!std::strcmp(argv[i], "--seconds"))
            o.seconds = std::atof(next());
        else if (!std::strcmp(argv[i], "--way"))
            o.way = next();
        else
            o.radii.push_back(std::atof(argv[i]));
    }
    if (o.radii.empty()) o.radii = {0.5, 0.1};
    return o;
}

} // namespace

int main(int argc, char** argv) {
    setThreadCount(1);
    try {
        run(read(argc, argv));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}

// How efficient light paths could be in the spot of bench_caustic if all but their rays cost nothing.
//   bench_caustic_bound, with the options of bench_caustic; --seconds 10 and --way 'alone=light-paths alone' by default
// Of N independent paths, each of which meets pixel i with probability p_i, the best estimate has a relative variance
// of 1 / (N p_i) in that pixel, less what is negligible; in the mean over the P pixels of the spot that is at least P /
// (N Σ p_i) (arithmetic and harmonic mean). So the efficiency, 1 / (relMSE × core-seconds), is at most
//     (paths a second) × (splats in the spot for each path) / P.
// Paths a second are those that tracing their rays alone allows: rays are kept while light paths are followed, then
// traced again, in the same order and by the same intersector. "least" is by asking whether anything lies on the ray at
// all, which finds no nearest hit and nothing about it. "ideal" is with that and with paths that all bring one splat,
// for four rays: to the ball, through it, to the floor, and to the lens.
#include "ball_spot_options.h"
#include "base/parallel.h"
#include "base/work.h"
#include "film/film_params.h"
#include "measure.h"
#include "support/forwarding_film.h"

#include <cstdio>

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
    bool occluded(Vec3 from, Vec3 to, float time, RayKind kind) const noexcept override {
        const float distance = length(to - from);
        keep({{from, (to - from) / distance, distance, time, kind}, false});
        return inner_->occluded(from, to, time, kind);
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
class CountingFilm final : public test::ForwardingFilm {
  public:
    CountingFilm(PixelFilm& film, const BallSpot& spot) : ForwardingFilm(film), spot_(spot) {}

    std::uint64_t inSpot() const { return inSpot_; }
    std::uint64_t lightPaths() const { return lightPaths_; }

    void splat(int x, int y, int replicate, const Splat& splat) noexcept override {
        inSpot_ += spot_.contains(static_cast<std::size_t>(y * bounds().width() + x));
        ForwardingFilm::splat(x, y, replicate, splat);
    }
    void countLightPaths(int replicate, std::uint64_t paths) noexcept override {
        lightPaths_ += paths;
        ForwardingFilm::countLightPaths(replicate, paths);
    }

  private:
    const BallSpot& spot_;
    std::uint64_t inSpot_ = 0, lightPaths_ = 0;
};

// Of a path that starts at the light.
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

LightPathCost costOf(const BallSpot& spot, const std::string& properties) {
    std::vector<KeptRay> rays;
    test::TestScene scene = spot.scene(properties);
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

void report(const BallSpot& spot, const BallSpotOptions::Way& way, double camera, double seconds) {
    const auto pixels = static_cast<double>(spot.area());
    const LightPathCost cost = costOf(spot, way.properties);
    const Efficiency light = measured(spot, way.properties, seconds);
    std::printf("  %s: %.2f rays, %.3f splats in the spot for each path; a ray %.0f ns, at least %.0f ns\n",
                way.name.c_str(), cost.rays, cost.share, 1e9 * cost.seconds, 1e9 * cost.anySeconds);
    std::printf("    efficiency %.3g, ×%.3g; relMSE %.3g, of independent splats at least %.3g\n", light.value,
                light.value / camera, light.relMse, pixels / (light.lightPaths * cost.share));
    const auto bound = [&](const char* name, double perSecond, double share) {
        const double efficiency = perSecond * share / pixels;
        std::printf("    bound, %-6s %.3g million paths/s: efficiency %.4g, ×%.4g\n", name, 1e-6 * perSecond,
                    efficiency, efficiency / camera);
    };
    bound("rays", 1 / (cost.rays * cost.seconds), cost.share);
    bound("least", 1 / (cost.rays * cost.anySeconds), cost.share);
    bound("ideal", 1 / (kIdealRays * cost.anySeconds), 1);
    std::fflush(stdout);
}

void run(const BallSpotOptions& o) {
    for (const double radius : o.radii) {
        const BallSpot spot(radius, o.view);
        const double camera = measured(spot, "light-paths off", o.seconds).value;
        std::printf("light of radius %g, spot of %zu pixels; camera paths: efficiency %.3g\n", radius, spot.area(),
                    camera);
        for (const BallSpotOptions::Way& way : o.ways) report(spot, way, camera, o.seconds);
    }
}

} // namespace

int main(int argc, char** argv) {
    setThreadCount(1);
    try {
        run(BallSpotOptions::read(argc, argv, {{}, 10, {{"alone", "light-paths alone"}}, {0.5, 0.1}}));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}

// Estimators of transmittance and of distances in a medium of voxels:  bench_media [RAYS]
//   1. relative variance × lookups of the density, for delta tracking, ratio tracking with the greatest density of all
//      and with that of each brick, and residual tracking as the renderer does it; every evaluation of the density is
//      counted, by the same counter. And microseconds per estimate, times relative variance.
//   2. collisions per second while rays are followed to where they scatter.
#include "measure.h"
#include "media/grid_medium.h"
#include "media/phase_functions.h"
#include "spectrum/curve.h"
#include "support/made_grids.h"
#include "transport/medium_tracker.h"
#include "volumes/brick_walk.h"
#include "volumes/noise.h"

#include <cstdio>
#include <cstdlib>

using namespace abbe;

namespace {

constexpr int kSide = 128; // voxels: 16 bricks

// Five octaves, the largest of four bricks, each `gain` times the one before; mean about 1, deviation about 0.7.
struct Fractal {
    const char* name;
    float gain, scale;

    float density(Vec3 p) const {
        p = p * (1 / 32.f);
        float sum = 0, amplitude = scale;
        for (std::uint32_t i = 0; i < 5; ++i) {
            sum += amplitude * gradientNoise(p, 7 + i * 0x9e3779b9u);
            amplitude *= gain;
            p = p * 2 + Vec3(0.37f, 0.71f, 0.13f);
        }
        return std::max(0.f, 1 + sum);
    }
};
constexpr Fractal kFractals[] = {{"smooth, octaves × 0.5", 0.5f, 2.3f}, {"rough, octaves × 0.8", 0.8f, 1.7f}};

VoxelGrid fractalGrid(const Fractal& fractal) {
    std::vector<Voxel> voxels;
    voxels.reserve(std::size_t{kSide} * kSide * kSide);
    for (int x = 0; x < kSide; ++x)
        for (int y = 0; y < kSide; ++y)
            for (int z = 0; z < kSide; ++z)
                voxels.push_back(
                    {{x, y, z},
                     fractal.density({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)})});
    GridFacts facts;
    facts.name = "density";
    return makeVoxelGrid(voxels, facts);
}

// Counts lookups. One thread.
class CountingWalk final : public MediumWalk {
  public:
    CountingWalk(MediumWalk& inner, std::uint64_t& lookups) : inner_(inner), lookups_(lookups) {}
    bool next(MediumSegment& s) noexcept override { return inner_.next(s); }
    float density(float t) noexcept override {
        ++lookups_;
        return inner_.density(t);
    }

  private:
    MediumWalk& inner_;
    std::uint64_t& lookups_;
};

class CountingMedium final : public Medium {
  public:
    explicit CountingMedium(const Medium& inner) : inner_(inner) {}
    Bounds3 bounds() const override { return inner_.bounds(); }
    MediumWalk* walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept override {
        MediumWalk* walk = inner_.walk(ray, tMax, space_);
        return walk ? space.make<CountingWalk>(*walk, lookups) : nullptr;
    }
    const Curve& extinction() const override { return inner_.extinction(); }
    const Curve& albedo() const override { return inner_.albedo(); }
    const PhaseFunction& phase() const override { return inner_.phase(); }

    mutable std::uint64_t lookups = 0;

  private:
    const Medium& inner_;
    mutable WalkSpace space_;
};

// A ray with the bounds of the bricks along it, none merged.
struct Line {
    Ray ray;
    float tMax = 0;
    double integral = 0;
    float greatest = 0;
    std::vector<MediumSegment> bricks;
};

Line makeLine(const VoxelGrid& grid, const BrickBounds& bounds) {
    Line line;
    const float a = 4 + 120 * uniform(), b = 4 + 120 * uniform();
    line.ray = {{a, b, -1}, {0, 0, 1}};
    line.tMax = kSide + 2;
    auto sampler = grid.sampler();
    constexpr int steps = 200'000;
    for (int i = 0; i < steps; ++i)
        line.integral +=
            static_cast<double>(line.tMax) / steps *
            static_cast<double>(
                sampler.at(line.ray.origin + line.ray.direction * (line.tMax * static_cast<float>((i + 0.5) / steps))));
    BrickWalk walk(bounds, Vec3d(line.ray.origin), Vec3d(line.ray.direction), 0, line.tMax);
    for (BrickSegment s; walk.next(s);) line.bricks.push_back({s.tNear, s.tFar, s.minimum, s.mean, s.maximum});
    line.greatest = bounds.maximum();
    return line;
}

enum class Estimator { delta, ratioGlobal, ratioBricks, residualBricks, ours };
constexpr const char* kNames[] = {"delta tracking, bounds of bricks", "ratio tracking, one bound",
                                  "ratio tracking, bounds of bricks", "residual, bricks, none merged",
                                  "MediumTracker::transmittance"};

// Textbook estimators over pieces with bounds, for comparison.
double estimate(Estimator e, std::span<const MediumSegment> pieces, double extinction, MediumWalk& walk,
                RandomStream& random) {
    double result = 1;
    for (const MediumSegment& s : pieces) {
        const bool residual = e == Estimator::residualBricks;
        const float control = residual ? s.mean : 0;
        const float bound = residual ? std::max(s.maximum - s.mean, s.mean - s.minimum) : s.maximum;
        result *= std::exp(-extinction * static_cast<double>(control) * static_cast<double>(s.tFar - s.tNear));
        const float rate = static_cast<float>(extinction) * bound;
        for (float t = s.tNear + random.exponential() / rate; t < s.tFar; t += random.exponential() / rate) {
            const float share = (walk.density(t) - control) / bound;
            if (e != Estimator::delta)
                result *= static_cast<double>(1 - share);
            else if (random.uniform() < share)
                return 0;
        }
    }
    return result;
}

struct Quality {
    double workVariance = 0, timeVariance = 0, lookups = 0, microseconds = 0, bias = 0;
};

Quality measure(Estimator e, const Line& line, const CountingMedium& medium, double tau, int n) {
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    const Wavelengths lambda = Wavelengths::sample(0.5f);
    const double extinction = tau / line.integral, truth = std::exp(-tau);
    std::vector<MediumSegment> pieces = line.bricks;
    if (e == Estimator::ratioGlobal) pieces = {{0, line.tMax, 0, 0, line.greatest}};
    double sum = 0, squares = 0;
    medium.lookups = 0;
    const double start = seconds(CLOCK_THREAD_CPUTIME_ID);
    for (int i = 0; i < n; ++i) {
        RandomStream random(mix64(static_cast<std::uint64_t>(i) + 77));
        double x;
        if (e == Estimator::ours) {
            x = static_cast<double>(tracker.transmittance(line.ray, line.tMax, {}, lambda, random)[0]);
        } else {
            WalkSpace space;
            x = estimate(e, pieces, extinction, *medium.walk(line.ray, line.tMax, space), random);
        }
        sum += x;
        squares += square(x - truth);
    }
    Quality q;
    q.microseconds = 1e6 * (seconds(CLOCK_THREAD_CPUTIME_ID) - start) / n;
    q.lookups = static_cast<double>(medium.lookups) / n;
    const double relative = squares / n / square(truth);
    q.workVariance = relative * q.lookups;
    q.timeVariance = relative * q.microseconds;
    q.bias = sum / n / truth - 1;
    return q;
}

MediumOptics optics(const Curve& extinction, const Curve& albedo) {
    MediumOptics o;
    o.extinction = &extinction;
    o.albedo = &albedo;
    o.phase = std::make_shared<HenyeyGreenstein>(0.f);
    return o;
}

// Of the density along the lines: what there is, and what is left of its variance within bricks.
void describe(const Fractal& fractal, const std::vector<Line>& lines, const VoxelGrid& grid) {
    double n = 0, sum = 0, squares = 0, left = 0;
    auto sampler = grid.sampler();
    for (const Line& line : lines)
        for (const MediumSegment& s : line.bricks)
            for (float t = s.tNear + 0.05f; t < s.tFar; t += 0.1f) {
                const double v = static_cast<double>(sampler.at(line.ray.origin + line.ray.direction * t));
                ++n, sum += v, squares += v * v, left += square(v - static_cast<double>(s.mean));
            }
    std::printf("\n%s: mean %.2f, deviation %.2f, from the means of bricks %.2f, greatest %.2f\n", fractal.name,
                sum / n, std::sqrt(squares / n - square(sum / n)), std::sqrt(left / n),
                static_cast<double>(grid.maximum()));
}

void shadowRays(const Fractal& fractal, int rays) {
    const VoxelGrid grid = fractalGrid(fractal);
    const BrickBounds bounds = BrickBounds::build(grid);
    std::vector<Line> lines;
    for (int i = 0; i < rays; ++i) lines.push_back(makeLine(grid, bounds));
    describe(fractal, lines, grid);
    const ConstantCurve black(0);
    std::printf("tau   estimator                          relvar×lookups  lookups  relvar×µs     µs    mean off\n");
    for (const double tau : {0.3, 1.0, 3.0, 8.0}) {
        std::vector<Quality> all(5);
        for (const Line& line : lines) {
            const ConstantCurve extinction(tau / line.integral);
            const GridMedium inner(optics(extinction, black), fractalGrid(fractal), 1, {});
            const CountingMedium medium(inner);
            for (int e = 0; e < 5; ++e) {
                const int n = tau > 5 ? 100'000 : 20'000;
                const Quality q = measure(static_cast<Estimator>(e), line, medium, tau, n);
                Quality& sum = all[static_cast<std::size_t>(e)];
                sum.workVariance += q.workVariance / rays;
                sum.timeVariance += q.timeVariance / rays;
                sum.lookups += q.lookups / rays;
                sum.microseconds += q.microseconds / rays;
                sum.bias += q.bias / rays;
            }
        }
        for (std::size_t e = 0; e < 5; ++e)
            std::printf("%-4g  %-34s %14.4g  %7.3g  %9.3g  %5.2f  %+7.2f %%\n", tau, kNames[e], all[e].workVariance,
                        all[e].lookups, all[e].timeVariance, all[e].microseconds, 100 * all[e].bias);
        std::printf("      ratio with bounds of bricks over ours: %.1f in lookups, %.1f in time\n",
                    all[2].workVariance / all[4].workVariance, all[2].timeVariance / all[4].timeVariance);
    }
}

// Rays from anywhere in the box to anywhere, so that they meet `mean` tentative collisions or scatter.
void collisions(double tau) {
    const ConstantCurve extinction(tau / kSide), white(1);
    const GridMedium medium(optics(extinction, white), fractalGrid(kFractals[0]), 1, {});
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    const Wavelengths lambda = Wavelengths::sample(0.5f);
    constexpr int n = 1'000'000;
    std::vector<Ray> rays;
    for (int i = 0; i < n; ++i)
        rays.push_back({Vec3(uniform(), uniform(), uniform()) * static_cast<float>(kSide), normalize(inBall())});
    std::uint64_t real = 0;
    const double start = seconds(CLOCK_THREAD_CPUTIME_ID);
    for (int i = 0; i < n; ++i) {
        RandomStream random(mix64(static_cast<std::uint64_t>(i)));
        Spectrum beta(1.f);
        real +=
            tracker.follow(rays[static_cast<std::size_t>(i)], kInfinity, {}, lambda, random, {&beta, nullptr}).medium !=
            nullptr;
    }
    const double time = seconds(CLOCK_THREAD_CPUTIME_ID) - start;
    std::printf("optical thickness %3g: %.2f M rays/s, %.2f M tentative and %.2f M real collisions/s\n", tau,
                n * 1e-6 / time, static_cast<double>(tracker.counters.collisions) * 1e-6 / time,
                static_cast<double>(real) * 1e-6 / time);
}

} // namespace

int main(int argc, char** argv) {
    for (const Fractal& fractal : kFractals) shadowRays(fractal, argc > 1 ? std::atoi(argv[1]) : 16);
    for (const double tau : {1.0, 10.0, 100.0, 1000.0}) collisions(tau);
}

// Participating media: cases 61 to 68 of docs/hard_cases.md.
#include "support/media.h"

#include "hard_cases/hard_case.h"
#include "media/homogeneous.h"
#include "media/noise_media.h"
#include "media/phase_functions.h"
#include "support/phase_check.h"
#include "support/scene_test.h"
#include "transport/medium_tracker.h"
#include "unit/volumes/voxel_cases.h"
#include "volumes/brick_walk.h"

using namespace abbe;
using namespace abbe::test;

namespace {

struct Followed {
    Spectrum beta{1.f}, density{1.f};
    bool scattered = false;
};

Followed follow(MediumTracker& tracker, RandomStream& random) {
    Followed result;
    const TrackedWeights weights{&result.beta, &result.density};
    result.scattered =
        tracker.follow({{}, {0, 0, 1}}, 1, {}, Wavelengths::sample(0.3f), random, weights).medium != nullptr;
    return result;
}

} // namespace

// A closed white room with a light of radiance 1 in its ceiling; in a closed room of albedo ρ light goes round 1/(1 -
// ρ) times.
TEST_CASE("case 61: nothing absorbs in a cloud") {
    HardCase c;
    const TestScene room = TestScene::parse(
        "scene 1\nfilm { size 4 4; filter box 0.5 }\ncamera { from 0 0 0.5; look-at 0 0 -1; fov 30 deg }\n"
        "light point { position 0 0 0; power 1 W }\nshape sphere { radius 1; material diffuse { reflectance 0.999 } "
        "}\n");
    const TestScene once = TestScene::parse(
        "scene 1\nfilm { size 4 4; filter box 0.5 }\ncamera { from 0 0 0.5; look-at 0 0 -1; fov 30 deg }\n"
        "light point { position 0 0 0; power 1 W }\nshape sphere { radius 1; material diffuse { reflectance 0.5 } }\n");
    REQUIRE_MESSAGE(!room.diagnostics().hasErrors(), room.report());
    const TestImage image = render(room, 64), half = render(once, 4096);
    // L = ρ E/π with E = Φ/(A (1 - ρ)): 999 and 1 times Φ/(π A).
    const Estimate bright = image.film.image(), dark = half.film.image();
    const double ratio = bright.mean / dark.mean;
    c.measured("error of the light in a closed room of albedo 0.999, in standard errors",
               std::abs(ratio - 999) /
                   (999 * std::sqrt(bright.variance / square(bright.mean) + dark.variance / square(dark.mean))),
               3);
    RenderSettings shallow = room.settings();
    shallow.samples = 64;
    shallow.maxDepth = 64;
    c.naive("with paths cut after 64 vertices", [&] {
        const TestImage cut = render(room, shallow);
        return std::abs(cut.film.image().mean / dark.mean - 999) / (999 * std::sqrt(bright.variance) / bright.mean);
    }());
    c.measured("paths that reach the cap", static_cast<double>(image.statistics.cappedPaths), 0);
    const TestScene cloud = TestScene::parse(
        "scene 1\nfilm { size 4 4; filter box 0.5 }\ncamera { from 0 0 4; look-at 0 0 0; fov 20 deg }\nlight sky { "
        "radiance 1 }\n"
        "shape sphere { radius 1; material boundary; interior homogeneous { extinction 20 per-m; albedo 1 } }\n");
    REQUIRE_MESSAGE(!cloud.diagnostics().hasErrors(), cloud.report());
    const TestImage white = render(cloud, 256);
    const Estimate e = white.film.image();
    c.measured("a ball of fog of albedo 1 and 40 mean free paths in a white sky, in standard errors",
               std::abs(e.mean - 1) / std::sqrt(e.variance), 3);
}

TEST_CASE("case 62: optical depths beyond the range of float") {
    HardCase c;
    double worst = 0;
    for (const double depth : {1.0, 1e4, 1e9}) {
        const SlopeCurve extinction(depth, depth), albedo(0.5, 0.5);
        const HomogeneousMedium medium(opticsOf(extinction, albedo));
        const Medium* const list[] = {&medium};
        MediumTracker tracker(list);
        RandomStream random(1);
        for (int i = 0; i < 200; ++i) {
            const Followed f = follow(tracker, random);
            for (int lane = 0; lane < kLanes; ++lane) {
                const double off = std::abs(static_cast<double>(f.density[lane]) - 1);
                worst = off <= worst ? worst : off;
            }
        }
    }
    c.measured("deviation of the ratio of equal densities from 1, optical depths up to 1e9", worst, 0);
    const volatile float t = std::exp(-1e4f);
    c.naive("exp(-1e4) over itself in single precision", static_cast<double>(t / t));
}

// Scattering is that rare that it is counted by where the random numbers lie: a collision within the depth τ has the
// probability τ. For each depth the exponential numbers below it are counted, of as many as are needed for 1e-3.
TEST_CASE("case 63: media thinner than 1e-6") {
    HardCase c;
    // The map from bits to numbers is monotone in the digits behind the first one: the share of those below τ follows
    // from bisection over them, without a thousand million samples.
    double worst = 0, naive = 0;
    for (const double tau : {1e-9, 1e-8, 1e-6}) {
        // Half of all numbers begin with a one; there x = -ln(1 - r) with r uniform below 1/2.
        double low = 0, high = 1;
        for (int k = 0; k < 60; ++k) {
            const double middle = (low + high) / 2;
            const auto bits = static_cast<std::uint64_t>(std::ldexp(middle, 63)) | 0x8000000000000000ull;
            (static_cast<double>(RandomStream::exponentialOf(bits)) < tau ? low : high) = middle;
        }
        worst = std::max(worst, std::abs(low / 2 / -std::expm1(-tau) - 1));
        double l = 0, h = 1; // -ln u with u in single precision, u near 1
        for (int k = 0; k < 60; ++k) {
            const double middle = (l + h) / 2;
            (static_cast<double>(-std::log(static_cast<float>(1 - middle))) < tau ? l : h) = middle;
        }
        naive = std::max(naive, std::abs(l / -std::expm1(-tau) - 1));
    }
    c.measured("relative error of the light scattered at optical depths from 1e-9 to 1e-6", worst, 1e-3);
    c.naive("distances as -ln u in single precision", naive);
    // And in the tracker: a thin medium a million times.
    const SlopeCurve extinction(1e-4, 1e-4), albedo(1, 1);
    const HomogeneousMedium medium(opticsOf(extinction, albedo));
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    RandomStream random(63);
    int scattered = 0;
    for (int i = 0; i < 3000000; ++i) scattered += follow(tracker, random).scattered;
    c.measured("collisions of 3e6 rays through a depth of 1e-4, in standard errors",
               std::abs(scattered - 300) / std::sqrt(300), 3);
}

TEST_CASE("case 64: −ln u of 24 bits") {
    HardCase c;
    c.atLeast("largest number of mean free paths that is drawn", static_cast<double>(RandomStream::exponentialOf(1)),
              18);
    c.naive("by -ln of a number of 24 bits", static_cast<double>(-std::log(0x1p-24f)));
    // Tails have the mass that they should.
    RandomStream random(64);
    std::vector<double> observed(40, 0.0), expected;
    constexpr int kSamples = 2000000;
    for (int i = 0; i < kSamples; ++i)
        ++observed[std::min<std::size_t>(39, static_cast<std::size_t>(2 * random.exponential()))];
    for (int i = 0; i < 39; ++i) expected.push_back(kSamples * std::exp(-i / 2.0) * -std::expm1(-0.5));
    expected.push_back(kSamples * std::exp(-39 / 2.0));
    c.atLeast("p of χ² of distances", chiSquareTest(observed, expected).pValue, 1e-4);
}

TEST_CASE("case 65: bound 0, segments without an end, voxels below 0 or no numbers") {
    HardCase c;
    int bad = 0;
    std::mt19937 random(65);
    const std::vector<std::vector<Voxel>> grids = {{},
                                                   block({0, 0, 0}, {16, 16, 16}, 1),
                                                   block({0, 0, 0}, {16, 16, 16}, 0),
                                                   {{{3, 3, 3}, 1}},
                                                   randomVoxels(1, 40, 200)};
    const float odd[] = {0, -0.f, 1, -1, 1e-38f, 1e38f, kInfinity, std::numeric_limits<float>::quiet_NaN()};
    for (const auto& voxels : grids) {
        const VoxelGrid grid = makeVoxelGrid(voxels, facts());
        const BrickBounds bounds = BrickBounds::build(grid);
        for (int i = 0; i < 3000; ++i) {
            const auto any = [&] {
                return static_cast<double>(i % 2 ? odd[random() % 8] : static_cast<float>(random() % 100) / 10 - 3);
            };
            const Vec3d o(any(), any(), any()), d(any(), any(), any());
            BrickWalk walk(bounds, o, d, 0, i % 3 ? kInfinity : 10.f);
            BrickSegment s;
            int steps = 0;
            float last = 0;
            while (walk.next(s) && ++steps < 100000) {
                bad +=
                    !(s.tFar > s.tNear) || !(s.tNear >= last) || !(s.maximum >= s.minimum) || !std::isfinite(s.maximum);
                last = s.tFar;
            }
            bad += steps >= 100000;
        }
    }
    c.measured("walks without an end or segments that are none, of 15000 rays through odd grids", bad, 0);
    const volatile float rate = 0, optical = 1;
    c.naive("distance to a collision at a bound of 0", static_cast<double>(optical / rate));
}

// Density 1 + 0.8 sin 4x in a slab, whose bound is said to be half of what it is.
TEST_CASE("case 66: a bound that does not bound") {
    HardCase c;
    class Halved final : public OpticalMedium {
      public:
        explicit Halved(MediumOptics optics, float factor) : OpticalMedium(std::move(optics)), factor_(factor) {}
        Bounds3 bounds() const override { return {{-1, -1, 0}, {1, 1, 1}}; }
        MediumWalk* walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept override {
            return space.make<Walk>(ray, std::min(tMax, 1.f), factor_);
        }

      private:
        class Walk final : public MediumWalk {
          public:
            Walk(const Ray&, float far, float factor) : far_(far), factor_(factor) {}
            bool next(MediumSegment& s) noexcept override {
                if (done_) return false;
                done_ = true;
                s = {0, far_, 0.2f, std::min(1.f, 1.8f * factor_), 1.8f * factor_};
                return true;
            }
            float density(float t) noexcept override { return 1 + 0.8f * std::sin(4 * t); }

          private:
            float far_, factor_;
            bool done_ = false;
        };
        float factor_;
    };
    const double exact = std::exp(-2 * (1 + 0.2 * (1 - std::cos(4.0))));
    const SlopeCurve extinction(2, 2), albedo(1, 1);
    double clamped = 0, relative = 1;
    for (const float factor : {0.5f, 1.f}) {
        const Halved medium(opticsOf(extinction, albedo), factor);
        const Medium* const list[] = {&medium};
        MediumTracker tracker(list);
        RandomStream random(66);
        Moments through, light;
        for (int i = 0; i < 300000; ++i) {
            through.add(static_cast<double>(
                tracker.transmittance({{}, {0, 0, 1}}, 1, {}, Wavelengths::sample(0.3f), random)[0]));
            const Followed f = follow(tracker, random);
            light.add(f.scattered ? 0 : static_cast<double>(f.beta[0]));
        }
        const double worst = std::max(std::abs(through.mean() - exact) / through.standardError(),
                                      std::abs(light.mean() - exact) / light.standardError());
        c.measured(
            fmt::format("error of the transmittance with bounds {} times what they are, in standard errors", factor),
            worst, 4);
        relative = std::abs(through.mean() / exact - 1);
        if (factor < 1)
            c.atLeast("densities above their bound that are counted", static_cast<double>(tracker.counters.exceeded),
                      1);
    }
    for (int i = 0; i < 100000; ++i) clamped += -2 * std::min(0.9, 1 + 0.8 * std::sin(4 * (i + 0.5) / 1e5)) / 1e5;
    c.measured("relative error of the transmittance with right bounds", relative, 0.01);
    c.naive("densities clamped to the bound", std::abs(std::exp(clamped) / exact - 1));
}

TEST_CASE("case 67: phase functions at g = 0 and g = ±1") {
    HardCase c;
    double least = 1;
    for (const double g : {-0.999, -1e-4, 0.0, 1e-4, 0.999}) {
        const HenyeyGreenstein phase(g);
        const Rings rings(std::abs(g) > 0.99 ? 0.002 : 0.05);
        std::vector<double> expected = rings.integrals([&](float x) { return static_cast<double>(phase.value(x)); }),
                            observed(rings.count());
        for (double& e : expected) e *= 100000;
        Random random(11);
        for (int i = 0; i < 100000; ++i) ++observed[rings.ring(phase.sampleCosine(random.uniform()))];
        least = std::min(least, chiSquareTest(observed, expected).pValue);
    }
    c.atLeast("least p of χ², g of 0, ±1e-4 and ±0.999", least, 1e-4);
    double worst = 0, naive = 0; // of the distribution function at what is sampled
    for (const double g : {1e-4, 1e-5, 1e-6})
        for (int i = 1; i < 100; ++i) {
            const double u = i / 100.0;
            const auto off = [&](float cosine) {
                const double below = (1 - g * g) / (2 * g) *
                                     (1 / std::sqrt(1 + g * g - 2 * g * static_cast<double>(cosine)) - 1 / (1 + g));
                return std::min(std::abs(below - u), std::abs(1 - below - u));
            };
            worst = std::max(worst, off(HenyeyGreenstein(g).sampleCosine(static_cast<float>(u))));
            const float narrow = static_cast<float>(g),
                        s = (1 - narrow * narrow) / (1 - narrow + 2 * narrow * static_cast<float>(u));
            naive = std::max(naive, off(std::clamp((1 + narrow * narrow - s * s) / (2 * narrow), -1.f, 1.f)));
        }
    c.measured("error of the distribution of sampled cosines, g of 1e-6 to 1e-4", worst, 1e-4);
    c.naive("by the textbook's inversion in single precision", naive);
}

TEST_CASE("case 68: voxels a million apart, empty grids, level sets, turned grids") {
    HardCase c;
    const std::vector<Voxel> voxels{{{0, 0, 0}, 1}, {{1'000'000, 0, 0}, 2}, {{-5, 1'000'000, -1'000'000}, 3}};
    const VoxelGrid grid = makeVoxelGrid(voxels, facts());
    const BrickBounds bounds = BrickBounds::build(grid);
    c.measured("bytes of three voxels a million apart", static_cast<double>(grid.bytes() + bounds.bytes()), 1e7);
    c.naive("of an array that holds them", 1e6 * 1e6 * 1e6 * sizeof(float));
    int bad = grid.sampler().at({1e6f, 0, 0}) != 2;
    bad += !makeVoxelGrid({}, facts()).empty() || !BrickBounds::build(makeVoxelGrid({}, facts())).empty();
    GridFacts turned = facts();
    turned.indexToWorld = Transform::rotate({1, 2, 3}, 0.7).then(Transform::scale({0.5, 2, 1}));
    const VoxelGrid t = makeVoxelGrid(block({0, 0, 0}, {8, 8, 8}, 1), turned);
    const Bounds3d box = t.worldBounds();
    for (int i = 0; i < 8; ++i) {
        const Vec3d corner = turned.indexToWorld.point(Vec3d(i & 1 ? 7 : 0, i & 2 ? 7 : 0, i & 4 ? 7 : 0));
        for (int a = 0; a < 3; ++a) bad += corner[a] < box.lower[a] || corner[a] > box.upper[a];
    }
    c.measured("voxels that are not found, corners of a turned grid outside of its bounds", bad, 0);
}

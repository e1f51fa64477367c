// What volumes of voxels give off: along rays, as a light, and that both mean the same.
#include "media/grid_emission.h"
#include "media/grid_medium.h"
#include "spectrum/emission_curves.h"
#include "support/chi_square.h"
#include "support/made_grids.h"
#include "support/media.h"

#include <doctest/doctest.h>
#include <random>

namespace abbe::test {
namespace {

const ConstantCurve kTwo(2), kQuarter(0.25);

MediumOptics optics() { return opticsOf(kTwo, kQuarter); }

// A ball of about 17 voxels with lumps, `value` in the middle.
VoxelGrid lumps(const Transform& place, float value, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> lump(0.2f, 1.f);
    std::vector<Voxel> voxels;
    for (int z = -17; z <= 17; ++z)
        for (int y = -17; y <= 17; ++y)
            for (int x = -17; x <= 17; ++x)
                if (x * x + y * y + z * z <= 17 * 17) voxels.push_back({{x, y, z}, value * lump(random)});
    return makeVoxelGrid(voxels, fogAt(place));
}

const Transform kAmounts = Transform::scale({0.1, 0.1, 0.1}).then(Transform::translate({3, 1, -2}));
// Another lattice over the same place.
const Transform kHeat = Transform::scale({0.16, 0.14, 0.15})
                            .then(Transform::rotate({1, 2, 3}, 0.7))
                            .then(Transform::translate({3.2, 1, -2}));
const Transform kWorld = Transform::scale({2, 2, 2}).then(Transform::translate({0, 5, 0}));

GridExtras hot() {
    GridExtras extras;
    extras.flame = ScaledGrid{lumps(kAmounts, 1, 2), 0.5, 0};
    extras.temperature = ScaledGrid{lumps(kHeat, 1, 3), 1700, 200};
    extras.glow = Glow::ofTemperature(*optics().extinction, *optics().albedo);
    return extras;
}

GridMedium fire() { return GridMedium(optics(), lumps(kAmounts, 1, 1), 1, kWorld, hot()); }

// ε at a point of render space, from the grids themselves.
double expected(Vec3d p, double nm) {
    const auto value = [&](const Transform& place, std::uint32_t seed) {
        static const VoxelGrid amounts = lumps(kAmounts, 1, 2), heat = lumps(kHeat, 1, 3);
        const VoxelGrid& grid = seed == 2 ? amounts : heat;
        return static_cast<double>(grid.sampler().at(Vec3(place.then(kWorld).inverse()->point(p))));
    };
    const double kelvin = 200 + 1700 * value(kHeat, 3);
    if (kelvin <= static_cast<double>(kColdest)) return 0;
    return 0.5 * value(kAmounts, 2) * 2 * 0.75 * planckRadiance(nm, kelvin);
}

constexpr float kNm = 610;

} // namespace

TEST_CASE("Planck's law at eight wavelengths is that of one") {
    for (const double kelvin : {401.0, 900.0, 1900.0, 6500.0, 1e5, 8e5, 2e6, 9e8}) {
        const Wavelengths w = Wavelengths::sample(0.21f);
        const Spectrum b = planckRadiance(w, static_cast<float>(kelvin));
        for (int i = 0; i < kLanes; ++i)
            CHECK(static_cast<double>(b[i]) ==
                  doctest::Approx(planckRadiance(static_cast<double>(w.nm[i]), kelvin)).epsilon(2e-5));
    }
    CHECK(planckRadiance(Wavelengths::single(800), 399.f)[0] == 0);
    CHECK(planckRadiance(Wavelengths::single(800), std::nanf(""))[0] == 0);
    // Less than 1e-13 of 1900 K, as it says.
    CHECK(planckRadiance(830, 400) < 1e-13 * planckRadiance(830, 1900));
}

TEST_CASE("emission along a ray is that of the grids, each in its own lattice") {
    const GridMedium medium = fire();
    REQUIRE(medium.emission());
    Random random(4);
    int lit = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec3 target = Vec3(6, 7, -4) + Vec3(random.uniform(), random.uniform(), random.uniform()) * 2.f;
        const Vec3 origin(0.3f, 9, 4);
        const Ray ray{origin, normalize(target - origin), 20, 0};
        WalkSpace space;
        EmissionWalk* walk = medium.emission()->walk(ray, ray.tMax, space);
        MediumSegment s;
        float end = 0;
        while (walk && walk->next(s)) {
            REQUIRE(s.tNear >= end);
            REQUIRE(s.tFar <= ray.tMax);
            // nothing emits between the segments
            for (int k = 0; k < 4 && s.tNear > end; ++k) {
                const float t = end + (s.tNear - end) * (static_cast<float>(k) + 0.5f) / 4;
                REQUIRE(expected(Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(t), 610) == 0);
            }
            end = s.tFar;
            const float t = s.tNear + (s.tFar - s.tNear) * random.uniform();
            const double want = expected(Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(t), 610);
            const double found = static_cast<double>(walk->emitted(t, Wavelengths::single(kNm))[0]);
            CHECK(found == doctest::Approx(want).epsilon(2e-3));
            lit += want > 0;
        }
    }
    CHECK(lit > 500);
}

TEST_CASE("the light's points follow the density that the emission states") {
    const GridMedium medium = fire();
    const VolumeLight light(*medium.gridEmission());
    const Vec3 from(0, 0, 1);
    // Bins of 4³ voxels, half bricks: their probability from the density at the points' places.
    const Transform toIndex = *kAmounts.then(kWorld).inverse();
    constexpr int kSide = 12, kLow = -24;
    std::vector<double> counts(kSide * kSide * kSide), want(counts.size());
    Random random(9);
    const int samples = chiSquareSamples();
    int missing = 0;
    for (int i = 0; i < samples; ++i) {
        const Vec2 u{random.uniform(), random.uniform()};
        const Vec3d p = toIndex.point(Vec3d(medium.gridEmission()->samplePoint(u)));
        const Vec3i bin(static_cast<int>(std::floor((p.x - kLow) / 4)), static_cast<int>(std::floor((p.y - kLow) / 4)),
                        static_cast<int>(std::floor((p.z - kLow) / 4)));
        REQUIRE(std::min({bin.x, bin.y, bin.z}) >= 0);
        REQUIRE(std::max({bin.x, bin.y, bin.z}) < kSide);
        ++counts[static_cast<std::size_t>((bin.x * kSide + bin.y) * kSide + bin.z)];
        const auto s = light.sample(from, 0, u, Wavelengths::single(kNm), 0);
        if (!s) {
            ++missing; // nothing is there
            continue;
        }
        if (i > 1000) continue;
        CHECK(s->pdfSolidAngle == doctest::Approx(medium.emission()->pdfSolidAngle(from, s->p)));
        CHECK(s->distance == doctest::Approx(length(s->p - from)));
        CHECK(length(s->wi - (s->p - from) / s->distance) < 1e-5f);
        CHECK_FALSE(s->delta);
    }
    CHECK(missing < samples / 2);
    const double edge = static_cast<double>(medium.gridEmission()->edge()), voxel = std::pow(0.2, 3);
    double total = 0;
    for (int x = 0; x < kSide; ++x)
        for (int y = 0; y < kSide; ++y)
            for (int z = 0; z < kSide; ++z) {
                const Vec3 p(
                    kAmounts.then(kWorld).point(Vec3d(Vec3i(x, y, z) * 4 + Vec3i(kLow + 2, kLow + 2, kLow + 2))));
                const Vec3 way = p - from;
                const double perVolume = static_cast<double>(medium.emission()->pdfSolidAngle(from, p)) /
                                         (static_cast<double>(dot(way, way)) * edge);
                const double probability = perVolume * voxel * 64;
                total += probability;
                want[static_cast<std::size_t>((x * kSide + y) * kSide + z)] = probability * samples;
            }
    CHECK(edge == doctest::Approx(1.6));
    CHECK(total == doctest::Approx(1).epsilon(1e-5));
    CHECK(chiSquareTest(counts, want).pValue > 1e-4);
    CHECK(medium.emission()->pdfSolidAngle(from, {0, 0, 0}) == 0);
}

TEST_CASE("the light has all that the grids give off, and nothing else") {
    const GridMedium medium = fire();
    const VolumeLight light(*medium.gridEmission());
    // Integrals of ε/r² over the volume, as it lights a point, by voxels and by the light.
    const Vec3 from(2, 3, 6);
    const Transform toRender = kAmounts.then(kWorld);
    double sum = 0;
    for (double x = -18; x < 18; x += 0.5)
        for (double y = -18; y < 18; y += 0.5)
            for (double z = -18; z < 18; z += 0.5) {
                const Vec3d p = toRender.point({x + 0.25, y + 0.25, z + 0.25}), way = p - Vec3d(from);
                sum += expected(p, 610) / dot(way, way) * 0.001;
            }
    Random random(11);
    Moments m;
    for (int i = 0; i < 2'000'000; ++i) {
        const auto s = light.sample(from, 0, {random.uniform(), random.uniform()}, Wavelengths::single(kNm), 0);
        m.add(s ? static_cast<double>(s->radiance[0]) / static_cast<double>(s->pdfSolidAngle) : 0);
    }
    CHECK(std::abs(m.mean() - sum) < 4 * std::sqrt(m.variance() / m.count()) + 2e-3 * sum);
    // Total power against the same sum.
    double watts = 0;
    for (double nm = 360; nm <= 830; nm += 10)
        for (double x = -18; x < 18; x += 2)
            for (double y = -18; y < 18; y += 2)
                for (double z = -18; z < 18; z += 2)
                    watts += 10 * 4 * kPiD * expected(toRender.point({x + 1, y + 1, z + 1}), nm) * 8 * 0.008;
    CHECK(light.power() == doctest::Approx(watts).epsilon(0.1));
    CHECK_FALSE(light.infinite());
    CHECK(light.emission() == medium.emission());
}

TEST_CASE("cold volumes do not shine, and dark bricks are left out") {
    GridExtras cold = hot();
    cold.temperature->scale = 150;
    CHECK_FALSE(GridMedium(optics(), lumps(kAmounts, 1, 1), 1, kWorld, std::move(cold)).emission());
    GridExtras without;
    CHECK_FALSE(GridMedium(optics(), lumps(kAmounts, 1, 1), 1, kWorld, std::move(without)).emission());
    // Density over 64 voxels, heat at 40 to 45 of them in a lattice of its own.
    std::vector<Voxel> wide, corner;
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 4; ++j) wide.push_back({{i, j, 0}, 1});
        if (i < 6) corner.push_back({{i, 0, 0}, 1});
    }
    GridExtras extras;
    extras.temperature = ScaledGrid{makeVoxelGrid(corner, fogAt(Transform::translate({40, 0, 0}))), 1500, 0};
    extras.glow = Glow::ofTemperature(kTwo);
    const GridMedium medium(optics(), makeVoxelGrid(wide, fogAt({})), 1, {}, std::move(extras));
    REQUIRE(medium.emission());
    WalkSpace space;
    MediumSegment s;
    EmissionWalk* walk = medium.emission()->walk({{-5, 0.3f, 0.2f}, {1, 0, 0}, 200, 0}, 200, space);
    float begin = 200, end = 0;
    while (walk && walk->next(s)) {
        begin = std::min(begin, s.tNear);
        end = s.tFar;
    }
    CHECK(begin <= 44); // of the brick before it the last cell glows, too
    CHECK(begin >= 37);
    CHECK(end >= 51);
    CHECK(end <= 53); // two bricks, not eight
}

TEST_CASE("a spectrum of its own needs no temperature") {
    GridExtras extras;
    extras.glow = Glow::ofSpectrum(kQuarter);
    const GridMedium medium(optics(), lumps(kAmounts, 1, 1), 3, kWorld, std::move(extras));
    REQUIRE(medium.emission());
    const Vec3 middle(kAmounts.then(kWorld).point({}));
    const double density = static_cast<double>(lumps(kAmounts, 1, 1).sampler().at({}));
    CHECK(medium.gridEmission()->emitted(middle, 0, Wavelengths::single(500))[0] ==
          doctest::Approx(0.25 * 3 * density).epsilon(1e-4));
}

} // namespace abbe::test

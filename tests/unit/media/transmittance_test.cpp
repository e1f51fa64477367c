// What comes through media without scattering, against integrals; and both ways of finding it against each other.
#include "media/atmosphere.h"
#include "media/grid_medium.h"
#include "media/homogeneous.h"
#include "support/made_grids.h"
#include "support/media.h"
#include "support/statistics.h"
#include "transport/medium_tracker.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const SlopeCurve kBlackSlope(0, 0);

MediumOptics optics(const Curve& extinction) { return opticsOf(extinction, kBlackSlope); }

// Mean of both estimators over many rays of the same way, lane by lane, against e^(-extinction · integral).
void checkTransmittance(const Medium& medium, const Ray& ray, float tMax, double integral) {
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    const Wavelengths lambda = Wavelengths::sample(0.37f);
    Moments direct[kLanes], tracked[kLanes];
    for (std::uint64_t i = 0; i < 40'000; ++i) {
        RandomStream random(mix64(i + 1));
        // Roulette of what is not worth its lookups leaves the mean alone, whatever it is told.
        const float least = static_cast<float>(i % 4) * 0.3f;
        const Spectrum t = tracker.transmittance(ray, tMax, {}, lambda, random, least);
        Spectrum beta(1.f), density(1.f);
        tracker.follow(ray, tMax, {}, lambda, random, {&beta, &density});
        const float sum = mean(density);
        for (int lane = 0; lane < kLanes; ++lane) {
            direct[lane].add(static_cast<double>(t[lane]));
            // Black: what does not come through has no weight left. The balance over rotations of one set of
            // wavelengths is not a lane's own mean, so only grey media are compared here.
            tracked[lane].add(static_cast<double>(beta[lane] / sum));
        }
    }
    for (int lane = 0; lane < kLanes; ++lane) {
        const double expected = std::exp(-medium.extinction().at(static_cast<double>(lambda.nm[lane])) * integral);
        const auto error = [](const Moments& m) { return std::sqrt(m.variance() / m.count()) + 1e-6; };
        CHECK(std::abs(direct[lane].mean() - expected) < 4.5 * error(direct[lane]));
        if (medium.extinction().isConstant())
            CHECK(std::abs(tracked[lane].mean() - expected) < 4.5 * error(tracked[lane]));
    }
    CHECK(tracker.counters.exceeded == 0);
}

// A bumpy ball of voxels of 0.1 m, nowhere thinner than that.
VoxelGrid makeGrid(float least = 0, int radius = 12) {
    std::vector<Voxel> voxels;
    for (int z = -radius; z <= radius; ++z)
        for (int y = -radius; y <= radius; ++y)
            for (int x = -radius; x <= radius; ++x)
                if (x * x + y * y + z * z <= radius * radius)
                    voxels.push_back(
                        {{x, y, z},
                         least +
                             static_cast<float>(
                                 (mix32(static_cast<std::uint32_t>(x * 961 + y * 31 + z + 100000)) & 1023) / 512.0)});
    GridFacts facts;
    facts.name = "density";
    facts.indexToWorld = Transform::scale({0.1, 0.1, 0.1});
    return makeVoxelGrid(voxels, facts);
}

// What is scattered before each of some places on a ray, evenly apart, against the integrals of density up to them.
void checkCollisions(const Medium& medium, const Ray& ray, float tMax, const std::vector<double>& integrals) {
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    const Wavelengths lambda = Wavelengths::sample(0.37f);
    std::vector<Moments> gone(integrals.size());
    for (std::uint64_t i = 0; i < 100'000; ++i) {
        RandomStream random(mix64(i + 1));
        Spectrum beta(1.f);
        const MediumCollision hit = tracker.follow(ray, tMax, {}, lambda, random, {&beta, nullptr});
        for (std::size_t k = 0; k < integrals.size(); ++k) {
            const float end = tMax * static_cast<float>(k + 1) / static_cast<float>(integrals.size());
            gone[k].add(hit.medium && hit.t < end ? static_cast<double>(mean(beta)) : 0);
        }
    }
    const double albedo = static_cast<double>(medium.albedo().at(lambda)[0]);
    for (std::size_t k = 0; k < integrals.size(); ++k) {
        const double expected =
            albedo * (1 - std::exp(-medium.extinction().at(static_cast<double>(lambda.nm[0])) * integrals[k]));
        CHECK(std::abs(gone[k].mean() - expected) <= 4.5 * std::sqrt(gone[k].variance() / gone[k].count()));
    }
}

} // namespace

TEST_CASE("homogeneous: exact, without a lookup") {
    const SlopeCurve extinction(0.2, 3.2);
    const HomogeneousMedium medium(optics(extinction));
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    const Wavelengths lambda = Wavelengths::sample(0.1f);
    RandomStream random(1);
    const Spectrum t = tracker.transmittance({{}, {0, 0, 1}}, 1.5f, {}, lambda, random);
    for (int lane = 0; lane < kLanes; ++lane)
        CHECK(t[lane] ==
              doctest::Approx(std::exp(-1.5 * extinction.at(static_cast<double>(lambda.nm[lane])))).epsilon(1e-6));
    CHECK(tracker.counters.lookups == 0);
    const Spectrum dense = tracker.transmittance({{}, {0, 0, 1}}, kInfinity, {}, lambda, random);
    CHECK_FALSE(anyNonZero(dense));
}

TEST_CASE("atmosphere: up, down, level and without an end") {
    const SlopeCurve grey(0.7, 0.7), slope(0.1, 1.6);
    for (const Curve* extinction : {static_cast<const Curve*>(&grey), static_cast<const Curve*>(&slope)}) {
        const Atmosphere medium(optics(*extinction), {0, 1, 0}, -1, 2);      // ground 1 m below, e-folding in 2 m
        const auto up = [](double h) { return 2 * (1 - std::exp(-h / 2)); }; // from the ground to height h
        checkTransmittance(medium, {{}, {0, 1, 0}}, 3, up(4) - up(1));
        checkTransmittance(medium, {{}, {0, 1, 0}}, kInfinity, 2 - up(1));
        checkTransmittance(medium, {{}, {0, -1, 0}}, 2, up(1) + 1);
        checkTransmittance(medium, {{}, {1, 0, 0}}, 2, 2 * std::exp(-0.5));
        checkTransmittance(medium, {{}, {0.6f, 0.8f, 0}}, 5, (up(5) - up(1)) / 0.8);
    }
}

TEST_CASE("voxels: both estimators against quadrature, whichever way the grid is turned") {
    const SlopeCurve grey(0.9, 0.9), slope(0.2, 1.7);
    const Transform places[] = {{}, Transform::rotate({1, 2, 3}, 0.7).then(Transform::translate({0.2, -0.1, 0.3}))};
    for (const Curve* extinction : {static_cast<const Curve*>(&grey), static_cast<const Curve*>(&slope)})
        for (const Transform& place : places) {
            const GridMedium medium(optics(*extinction), makeGrid(), 1.5, place);
            const VoxelGrid grid = makeGrid();
            auto sampler = grid.sampler();
            const Transform toIndex = *grid.indexToWorld().then(place).inverse();
            for (const Vec3 direction : {Vec3{0, 0, 1}, normalize(Vec3{0.3f, 0.2f, 1})}) {
                const Ray ray{{0.05f, 0.03f, -2}, direction};
                constexpr int steps = 200'000;
                double integral = 0;
                for (int i = 0; i < steps; ++i) {
                    const double t = 4.0 * (i + 0.5) / steps;
                    integral += 4.0 / steps * 1.5 *
                                static_cast<double>(
                                    sampler.at(Vec3(toIndex.point(Vec3d(ray.origin) + Vec3d(ray.direction) * t))));
                }
                REQUIRE(integral > 0.5);
                checkTransmittance(medium, ray, 4, integral);
            }
        }
}

TEST_CASE("voxels: collisions are where the density is, with a least density throughout or without") {
    const SlopeCurve grey(0.9, 0.9), white(1, 1), clear(0.93, 0.93), dark(0.5, 0.5);
    // Bricks inside the ball have a least density; those at its rim and what is outside have none.
    VoxelGrid grid = makeGrid(2, 24);
    auto sampler = grid.sampler();
    const Transform toIndex = *grid.indexToWorld().inverse();
    const Ray ray{{0.05f, 0.03f, -3}, normalize(Vec3{0.3f, 0.2f, 1})};
    constexpr int steps = 80'000, places = 8;
    std::vector<double> integrals;
    double integral = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = 4.0 * (i + 0.5) / steps;
        integral += 4.0 / steps * 0.25 *
                    static_cast<double>(sampler.at(Vec3(toIndex.point(Vec3d(ray.origin) + Vec3d(ray.direction) * t))));
        if ((i + 1) % (steps / places) == 0) integrals.push_back(integral);
    }
    for (const Curve* albedo :
         {static_cast<const Curve*>(&white), static_cast<const Curve*>(&clear), static_cast<const Curve*>(&dark)})
        checkCollisions(GridMedium(opticsOf(grey, *albedo), makeGrid(2, 24), 0.25, {}), ray, 4, integrals);
}

} // namespace abbe::test

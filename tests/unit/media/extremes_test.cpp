// Optical lengths that leave the range of float, and distances that few random numbers reach.
#include "media/homogeneous.h"
#include "support/media.h"
#include "transport/medium_tracker.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

struct Followed {
    Spectrum beta{1.f}, density{1.f};
    bool scattered = false;
};

Followed follow(const SlopeCurve& extinction, const SlopeCurve& albedo, std::uint64_t seed) {
    const HomogeneousMedium medium(opticsOf(extinction, albedo));
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    RandomStream random(seed);
    Followed result;
    const TrackedWeights weights{&result.beta, &result.density};
    result.scattered =
        tracker.follow({{}, {0, 0, 1}}, 1, {}, Wavelengths::sample(0.3f), random, weights).medium != nullptr;
    return result;
}

} // namespace

TEST_CASE("distances beyond 16.6 mean free paths, the last of 24 bits, are drawn") {
    CHECK(RandomStream(149030279).exponential() > 18); // one number in 66 million is that large
}

TEST_CASE("extinction that is the same at all wavelengths leaves their densities alone, however large it is") {
    for (const double depth : {1e-9, 1.0, 1e4, 1e9})
        for (const double albedo : {0.0, 0.5, 1.0})
            for (std::uint64_t seed = 1; seed < 20; ++seed) {
                const Followed f = follow({depth, depth}, {albedo, albedo}, seed);
                for (int lane = 0; lane < kLanes; ++lane) {
                    CHECK(f.density[lane] == 1);
                    CHECK(f.beta[lane] == f.beta[0]);
                }
            }
}

TEST_CASE("wavelengths whose transmittances have no digits left have ratios all the same") {
    int scattered = 0;
    for (const double depth : {1e2, 1e4, 1e8})
        for (std::uint64_t seed = 1; seed < 200; ++seed) {
            const Followed f = follow({depth, 16 * depth}, {1, 1}, seed);
            float largest = 0;
            for (int lane = 0; lane < kLanes; ++lane) {
                REQUIRE(std::isfinite(f.beta[lane]));
                REQUIRE(f.density[lane] >= 0);
                largest = std::max(largest, f.density[lane]);
            }
            CHECK(largest == doctest::Approx(1));
            scattered += f.scattered;
        }
    CHECK(scattered == 3 * 199);
}

} // namespace abbe::test

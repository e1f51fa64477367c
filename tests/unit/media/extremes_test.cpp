// Optical lengths that leave the range of float, and distances that few random numbers reach.
#include "media/homogeneous.h"
#include "media/medium_optics.h"
#include "support/media.h"
#include "support/statistics.h"
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

// A bubble in what may be anything up to density 1: nothing is there, and all light passes.
class Bubble final : public OpticalMedium {
  public:
    explicit Bubble(MediumOptics optics) : OpticalMedium(std::move(optics)) {}
    Bounds3 bounds() const override {
        return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
    }
    MediumWalk* walk(const Ray&, float tMax, WalkSpace& space) const noexcept override {
        return space.make<Walk>(tMax);
    }

  private:
    class Walk final : public MediumWalk {
      public:
        explicit Walk(float tMax) : segment_{0, tMax, 0, 0.5f, 1} {}
        bool next(MediumSegment& segment) noexcept override {
            segment = segment_;
            return !std::exchange(done_, true);
        }
        float density(float) noexcept override { return 0; }

      private:
        MediumSegment segment_;
        bool done_ = false;
    };
};

// Evenly from 360 to 830 nm, turned so that lane 0 takes the given one.
Wavelengths evenWavelengths(int hero) {
    Spectrum nm;
    for (int i = 0; i < kLanes; ++i)
        nm.v[i] = 360 + 470 * static_cast<float>((i + hero) % kLanes) / static_cast<float>(kLanes - 1);
    return Wavelengths::at(nm, Spectrum(1.f));
}

// All of it but for what random numbers may do to the mean.
void checkAllPasses(const Moments& share) {
    CHECK(std::abs(share.mean() - 1) < 4.5 * std::sqrt(share.variance() / share.count()) + 1e-4);
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

// Weights of 2 for each of 200 lookups, beyond the range of float, and e^-200 for the mean density.
TEST_CASE("transmittance of a bubble in a dense coloured medium: finite weights, and the mean") {
    const SlopeCurve extinction(8, 400), albedo(0, 0);
    const Bubble medium(opticsOf(extinction, albedo));
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    Moments thin; // of the wavelength that the control leaves little variance
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        RandomStream random(mix64(seed));
        const Spectrum t = tracker.transmittance({{}, {0, 0, 1}}, 1, {}, evenWavelengths(0), random);
        REQUIRE(allFinite(t));
        thin.add(static_cast<double>(t[0]));
    }
    checkAllPasses(thin);
    CHECK(std::sqrt(thin.variance() / thin.count()) < 0.004);
}

// Rates of collisions with nothing: 38^26 of the densest wavelength's over the thinnest one's; and 38^-1000 and e^974
// of the thinnest one's over the densest one's.
TEST_CASE("paths through a bubble in a dense coloured medium: finite weights, and the mean at each wavelength") {
    const SlopeCurve extinction(1000.0 / 38, 1000), albedo(1, 1);
    const Bubble medium(opticsOf(extinction, albedo));
    const Medium* const list[] = {&medium};
    MediumTracker tracker(list);
    Moments through[kLanes];
    for (std::uint64_t seed = 1; seed <= 500; ++seed) {
        double shares[kLanes] = {}; // of one set of wavelengths, each in turn the hero
        for (int hero = 0; hero < kLanes; ++hero) {
            RandomStream random(mix64(seed * kLanes + static_cast<std::uint64_t>(hero)));
            Spectrum beta(1.f), density(1.f);
            const auto collision =
                tracker.follow({{}, {0, 0, 1}}, 1, {}, evenWavelengths(hero), random, {&beta, &density});
            REQUIRE(collision.medium == nullptr);
            REQUIRE(allFinite(beta));
            REQUIRE(allFinite(density));
            REQUIRE(maxLane(density) == doctest::Approx(1));
            for (int lane = 0; lane < kLanes; ++lane)
                shares[(lane + hero) % kLanes] += static_cast<double>(beta[lane] / sum(density));
        }
        for (int lane = 0; lane < kLanes; ++lane) through[lane].add(shares[lane]);
    }
    for (const Moments& share : through) checkAllPasses(share);
}

} // namespace abbe::test

// Phase functions: what is sampled is what is evaluated.
#include "media/draine.h"
#include "media/henyey_greenstein.h"
#include "support/chi_square.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// In cosines that crowd where the lobe is: equal steps of the angle.
void check(const PhaseFunction& phase, double meanCosine) {
    constexpr int bins = 180, samples = 200'000;
    const auto cosineAt = [](double bin) { return -std::cos(kPiD * bin / bins); };
    std::vector<double> observed(bins), expected(bins);
    double total = 0, mean = 0;
    for (int b = 0; b < bins; ++b) {
        constexpr int steps = 400;
        for (int i = 0; i < steps; ++i) {
            const double lower = cosineAt(b + i / double{steps}), upper = cosineAt(b + (i + 1) / double{steps});
            const double c = 0.5 * (lower + upper);
            const double mass = 2 * kPiD * static_cast<double>(phase.value(static_cast<float>(c))) * (upper - lower);
            expected[b] += mass * samples;
            total += mass;
            mean += mass * c;
        }
    }
    CHECK(total == doctest::Approx(1).epsilon(0.002));
    CHECK(mean == doctest::Approx(meanCosine).epsilon(0.003));
    Random random(11);
    for (int i = 0; i < samples; ++i) {
        const float c = phase.sampleCosine(random.uniform());
        REQUIRE(std::abs(c) <= 1);
        const double angle = std::acos(-static_cast<double>(c)) / kPiD * bins;
        ++observed[static_cast<std::size_t>(std::clamp(angle, 0.0, bins - 1.0))];
    }
    CHECK(chiSquareTest(observed, expected).pValue > 1e-4);
}

} // namespace

TEST_CASE("Henyey-Greenstein: density 1 over the sphere, mean cosine g, sampled exactly") {
    for (const double g : {-0.98, -0.5, -1e-4, 0.0, 1e-4, 2e-3, 0.3, 0.85, 0.98}) {
        INFO(g);
        check(HenyeyGreenstein(g), g);
    }
}

TEST_CASE("Draine: Rayleigh and Henyey-Greenstein as limits, and between") {
    check(Draine(0, 1), 0);
    for (const float c : {-1.f, -0.3f, 0.f, 0.7f, 1.f}) {
        CHECK(Draine(0, 1).value(c) == doctest::Approx(3 / (16 * kPiD) * (1 + c * c)).epsilon(1e-5));
        CHECK(Draine(0.6, 0).value(c) == doctest::Approx(HenyeyGreenstein(0.6).value(c)).epsilon(1e-4));
    }
    // The mean of Draine's own paper: g (1 + α (3 + 2 g²) / 5) / (1 + α (1 + 2 g²) / 3).
    for (const double g : {-0.7, 0.02, 0.4, 0.9})
        for (const double alpha : {0.0, 0.5, 1.0, 20.0}) {
            INFO(g);
            INFO(alpha);
            check(Draine(g, alpha), g * (1 + alpha * (3 + 2 * g * g) / 5) / (1 + alpha * (1 + 2 * g * g) / 3));
        }
}

} // namespace abbe::test

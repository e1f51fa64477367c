#include "study/reference_pair.h"
#include "study/study_store.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

constexpr int kSide = 96;

double truthAt(std::size_t component) { return 0.2 + 0.8 * static_cast<double>(component % 7) / 7; }

// The truth with a bias and independent noise, both relative to it.
StudyImage made(std::uint64_t seed, double noise, double bias = 0) {
    StudyImage image{kSide, kSide, {}};
    test::Random random(seed);
    for (std::size_t c = 0; c < 3 * kSide * kSide; ++c) {
        const double n = std::sqrt(12.0) * (random.uniformDouble() - 0.5); // variance 1
        image.rgb.push_back(static_cast<float>(truthAt(c) * (1 + bias + noise * n)));
    }
    return image;
}

// Of values t(1 + δ): δ² t²/(t² + ε).
double expectedRelMse(double squared) {
    double mean = 0, sum = 0;
    for (std::size_t c = 0; c < 7; ++c) mean += truthAt(c) / 7;
    for (std::size_t c = 0; c < 7; ++c) {
        const double t2 = truthAt(c) * truthAt(c);
        sum += squared * t2 / (t2 + 0.01 * mean * mean) / 7;
    }
    return sum;
}

} // namespace

TEST_CASE("the noise of the reference cancels") {
    // A reference of two noisy halves: as bad as the image itself.
    const double noise = 0.05;
    test::Moments found;
    for (std::uint64_t study = 0; study < 20; ++study) {
        const ReferencePair reference(made(100 + 3 * study, noise), made(101 + 3 * study, noise));
        found.add(reference.measure(made(102 + 3 * study, noise)).relMse);
        CHECK(reference.relMse() == doctest::Approx(expectedRelMse(noise * noise / 2)).epsilon(0.1));
    }
    const double truth = expectedRelMse(noise * noise);
    CHECK(std::abs(found.mean() - truth) < 4 * found.standardError() + 0.01 * truth);
    // Against the mean of both halves as if it were the truth half as much again would be found.
    CHECK(found.standardError() < 0.1 * truth);
}

TEST_CASE("figures of an error") {
    const ReferencePair reference(made(1, 0), made(2, 0));
    StudyImage image = made(3, 0);
    CHECK(reference.measure(image).relMse == doctest::Approx(0).epsilon(1e-9));
    image.rgb[3 * (5 * kSide + 40)] += 100; // one pixel, which is in the tail
    const ReferencePair::Error error = reference.measure(image);
    CHECK(error.relMse > 0.1);
    CHECK(error.trimmed < 1e-9);
    CHECK(error.tiles.size() == 36);
    CHECK(error.tiles[2] == doctest::Approx(error.relMse * 36));
    CHECK(error.tiles[3] < 1e-9);
    const std::vector<float> map = reference.errorMap(image);
    CHECK(map[5 * kSide + 40] > 10);
    CHECK(map[5 * kSide + 41] < 1e-3f);
}

TEST_CASE("bias is found through the noise of eight seeds") {
    const double noise = 0.1;
    int found = 0, falselyFound = 0, covered = 0;
    constexpr int kStudies = 100;
    for (std::uint64_t study = 0; study < kStudies; ++study) {
        const ReferencePair reference(made(10000 + study, 0.02), made(20000 + study, 0.02));
        for (const double bias : {0.0, 0.01}) {
            CurveRecord record{"x", {{4, {}, {}, {}}}, {}, 0};
            for (std::uint64_t seed = 1; seed <= 8; ++seed) {
                record.runs.push_back({seed, {{}}});
                record.measure(reference, {made(100 * study + seed, noise, bias)});
            }
            const Estimate e = reference.biasSquared(record.rungs[0].sum, record.rungs[0].tiles, record.measured);
            REQUIRE(e.bounded());
            (bias > 0 ? found : falselyFound) += e.low > 0;
            covered += bias > 0 && e.low <= expectedRelMse(1e-4) && expectedRelMse(1e-4) <= e.high;
        }
    }
    CHECK(found >= 95); // 1 % of bias in 10 % of noise
    CHECK(falselyFound <= 8);
    CHECK(covered >= 88);
}

TEST_CASE("bias of one seed is unknown") {
    const ReferencePair reference(made(1, 0.1), made(2, 0.1));
    const StudyImage image = made(3, 0.1);
    CHECK_FALSE(reference.biasSquared(image, reference.measure(image).tiles, 1).known());
}

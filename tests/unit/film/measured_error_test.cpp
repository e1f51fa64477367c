#include "film/error_figure.h"
#include "film/measured_error.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <numbers>
#include <random>

namespace abbe::test {
namespace {

using Planes = MeasuredError::Planes;

constexpr int kSide = 24;

double trueLight(std::size_t i) { return 0.1 + 0.9 * static_cast<double>(i % kSide) / kSide; }

// Two independent sets of samples, as a film keeps them: their mean, and the variance of that by one degree of freedom.
Planes noisy(std::mt19937& random, double deviation) {
    std::normal_distribution<double> normal(0, deviation * std::numbers::sqrt2);
    Planes planes{kSide, kSide, {}, {}, {}};
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
        const double a = normal(random), b = normal(random);
        planes.luminance.push_back(static_cast<float>(trueLight(i) * (1 + (a + b) / 2)));
        planes.variance.push_back(static_cast<float>(std::pow(trueLight(i) * (a - b) / 2, 2)));
    }
    return planes;
}

double trueError(const Planes& image) {
    const RelativeError measure(image.luminance);
    double sum = 0;
    for (std::size_t i = 0; i < image.luminance.size(); ++i) sum += measure.squared(image.luminance[i], trueLight(i));
    return std::sqrt(sum / static_cast<double>(image.luminance.size()));
}

struct Trials {
    int held = 0;
    double ratio = 0; // measured over true square, mean

    void add(const MeasuredSquare& m, const ErrorFigure& interval, double error) {
        held += interval.holds(error);
        ratio += m.value / (error * error) / 100;
    }
};

} // namespace

// References only twice as good as the image: their noise is a quarter of what it differs from them by.
TEST_CASE("measured error: the noise of references is taken off, and what that leaves open is told") {
    std::mt19937 random(1);
    Trials two, one, blind;
    for (int trial = 0; trial < 100; ++trial) {
        const Planes image = noisy(random, 0.1), a = noisy(random, 0.05), b = noisy(random, 0.05);
        const double error = trueError(image);
        const MeasuredSquare pair = MeasuredError::of(image, a, b).relative;
        two.add(pair, pair.root(), error);
        const MeasuredSquare single = MeasuredError::of(image, a).relative;
        one.add(single, single.root(), error);
        CHECK(single.referenceNoise == doctest::Approx(0.05 * 0.05).epsilon(0.3));
        Planes mute = a;
        mute.variance.clear();
        const MeasuredSquare exact = MeasuredError::of(image, mute).relative;
        blind.add(exact, exact.root(), error);
        CHECK(exact.standardError == 0);
    }
    MESSAGE(fmt::format("held: two references {}, one {}, one that counts as exact {}; ratios {:.3f} {:.3f} {:.3f}",
                        two.held, one.held, blind.held, two.ratio, one.ratio, blind.ratio));
    for (const Trials& t : {two, one}) {
        CHECK(t.held >= 90);
        CHECK(t.ratio == doctest::Approx(1).epsilon(0.03));
    }
    CHECK(blind.held == 0);
    CHECK(blind.ratio == doctest::Approx(1.25).epsilon(0.05));
}

TEST_CASE("measured error: a reference with the image's own samples bounds it") {
    std::mt19937 random(2);
    int held = 0, independent = 0;
    for (int trial = 0; trial < 100; ++trial) {
        const Planes image = noisy(random, 0.1), rest = noisy(random, 0.1);
        Planes whole = image; // twice the samples, of which the image has the first half
        for (std::size_t i = 0; i < whole.luminance.size(); ++i) {
            whole.luminance[i] = (image.luminance[i] + rest.luminance[i]) / 2;
            whole.variance[i] = (image.variance[i] + rest.variance[i]) / 4;
        }
        const MeasuredSquare m = MeasuredError::of(image, whole).relative;
        held += m.rootOfDependent().holds(trueError(image));
        independent += m.root().holds(trueError(image));
    }
    CHECK(held == 100);
    CHECK(independent == 0); // as if they had nothing in common: a tenth of the truth
}

TEST_CASE("measured error: the reference's certificate takes the place of variances") {
    std::mt19937 random(3);
    int held = 0;
    for (int trial = 0; trial < 100; ++trial) {
        const Planes image = noisy(random, 0.1);
        Planes a = noisy(random, 0.05);
        a.variance.clear();
        const ErrorFigure own{0.05, 0.047, 0.053, kSide * kSide, {}};
        held += withoutNoise(MeasuredError::of(image, a).relative, own).root().holds(trueError(image));
    }
    CHECK(held >= 90);
}

TEST_CASE("measured error: pixels whose variance nobody knows are left out") {
    Planes image{2, 1, {1, 1}, {}, {}}, reference{2, 1, {1.1f, 9}, {0, INFINITY}, {}};
    const MeasuredSquare m = MeasuredError::of(image, reference).relative;
    CHECK(m.value == doctest::Approx(0.01 / ((1 + 1.21) / 2 + 0.01)).epsilon(1e-5));
}

} // namespace abbe::test

#include "io/image_compare.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>
#include <vector>

using namespace abbe;

namespace {

constexpr int kWidth = 128, kHeight = 128;

enum class Noise { normal, exponential };

struct Render {
    std::vector<float> values, variances;
};

// Means and variances of means of R replicates; the exponential noise is as skewed as that of a dim pixel.
Render render(std::mt19937& random, int replicates, double bias, Noise noise) {
    std::normal_distribution<double> normal;
    std::exponential_distribution<double> exponential;
    Render result;
    for (int i = 0; i < kWidth * kHeight; ++i) {
        const double level = 0.2 + (i % kWidth) / 150.0, sigma = 0.05 + 0.2 * (i / kWidth) / kHeight;
        double sum = 0, squares = 0;
        for (int k = 0; k < replicates; ++k) {
            const double z = noise == Noise::normal ? normal(random) : exponential(random) - 1;
            const double x = level * bias * (1 + sigma * z);
            sum += x;
            squares += x * x;
        }
        result.values.push_back(static_cast<float>(sum / replicates));
        result.variances.push_back(
            static_cast<float>(std::max(0.0, squares - sum * sum / replicates) / (replicates - 1) / replicates));
    }
    return result;
}

TileTest test(std::mt19937& random, int replicates, double bias, Noise noise) {
    const Render a = render(random, replicates, bias, noise), b = render(random, replicates, 1, noise);
    return tileTest({a.values, a.variances, replicates, 0x1p-22}, {b.values, b.variances, replicates, 0x1p-22}, kWidth,
                    kHeight);
}

} // namespace

// At a level of 1 % for either part, false alarms in 100 pairs are Poisson with a mean of at most 2; more than 8 have a
// probability of 2·10⁻⁴.
TEST_CASE("tile test: false alarms are as rare as they should be, and a bias of 1 % is found") {
    for (const int replicates : {2, 4, 8})
        for (const Noise noise : {Noise::normal, Noise::exponential}) {
            std::mt19937 random(static_cast<unsigned>(100 * replicates + static_cast<int>(noise)));
            int alarms = 0, fivePercent = 0;
            double deviation = 0;
            for (int i = 0; i < 100; ++i) {
                const TileTest t = test(random, replicates, 1, noise);
                alarms += t.probability() < 0.01;
                deviation += t.deviation / 100;
                fivePercent += t.kolmogorovProbability < 0.05;
            }
            MESSAGE(replicates << " replicates: " << alarms << " alarms, " << fivePercent << " below 5 %, deviation "
                               << deviation);
            CHECK(alarms <= 8);
            CHECK(std::abs(deviation - 1) < (noise == Noise::normal ? 0.015 : 0.025)); // ± 0.004, one standard error
            CHECK(fivePercent <= 22);                                                  // 10 expected
            int found = 0;
            for (int i = 0; i < 10; ++i) found += test(random, replicates, 1.01, noise).probability() < 0.01;
            CHECK(found >= 9);
        }
}

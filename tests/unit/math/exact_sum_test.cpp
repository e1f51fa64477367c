#include "math/exact_sum.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <random>
#include <vector>

namespace abbe::test {

TEST_CASE("an exact sum of one term is the term, from 1e-9 to the largest, of either sign") {
    for (const double x : {0.0, 1.0, -1.0, 0.1, -0.1, 1e-3, 123456.789, -98765.4321, 1e12, -4.3e12, 0x1p-72, -0x1p-72})
        CHECK(ExactSum(x).value() == x);
    // Below the resolution of 53 bits at 2⁻⁷²: rounded down.
    for (const double x : {1e-9, -1e-9, 3.3e-15, -3.3e-15}) {
        CHECK(ExactSum(x).value() <= x);
        CHECK(ExactSum(x).value() > x - 0x1p-72);
    }
    CHECK(ExactSum(1e-30).value() == 0);
    const double nearLimit = std::nextafter(ExactSum::kLargest, 0);
    CHECK(ExactSum(nearLimit).value() == nearLimit);
    CHECK(ExactSum(-nearLimit).value() == -nearLimit);
}

TEST_CASE("exact sums do not depend on the order or the grouping of their terms, where sums of doubles do") {
    std::mt19937_64 random(5);
    std::vector<double> terms;
    for (int i = 0; i < 10000; ++i)
        terms.push_back(
            std::ldexp(std::uniform_real_distribution(-1.0, 1.0)(random), static_cast<int>(random() % 60) - 30));
    const auto sum = [&] {
        ExactSum total;
        double plain = 0;
        for (const double t : terms) {
            total += ExactSum(t);
            plain += t;
        }
        return std::pair(total, plain);
    };
    const auto [first, plain] = sum();
    int plainDiffers = 0;
    for (int trial = 0; trial < 5; ++trial) {
        std::shuffle(terms.begin(), terms.end(), random);
        const auto [total, otherPlain] = sum();
        CHECK(total == first);
        plainDiffers += otherPlain != plain;
    }
    CHECK(plainDiffers > 0);
    ExactSum halves[2];
    for (std::size_t i = 0; i < terms.size(); ++i) halves[i % 2] += ExactSum(terms[i]);
    CHECK(halves[1] + halves[0] == first);
    CHECK(first.value() == doctest::Approx(plain).epsilon(1e-12));
}

TEST_CASE("an exact sum returns from its bits") {
    for (const double x : {0.0, -1.5, 1e12, -3e-9}) {
        const ExactSum sum(x);
        CHECK(ExactSum::ofBits(sum.high(), sum.low()) == sum);
    }
}

} // namespace abbe::test

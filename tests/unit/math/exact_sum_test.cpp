#include "math/exact_sum.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <random>
#include <thread>
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

namespace {

// Of either sign and of all sizes, so that most additions carry or borrow.
std::vector<ExactSum> terms(std::size_t count, unsigned seed) {
    std::mt19937_64 random(seed);
    std::vector<ExactSum> list;
    for (std::size_t i = 0; i < count; ++i)
        list.emplace_back(
            std::ldexp(std::uniform_real_distribution(-1.0, 1.0)(random), static_cast<int>(random() % 80) - 50));
    return list;
}

} // namespace

TEST_CASE("a shared sum carries as an exact sum does") {
    ExactSum exact;
    SharedSum shared;
    for (const ExactSum& t : terms(100000, 1)) {
        exact += t;
        shared.add(t);
    }
    CHECK(shared.sum() == exact);
    // At the edges of the low word.
    for (const double x : {0x1p-8, 0x1p-8 - 0x1p-60, 0x1p-72, -0x1p-72, -0x1p-8, 0x1p-9}) {
        SharedSum s;
        ExactSum e;
        for (int i = 0; i < 5; ++i) {
            s.add(ExactSum(x));
            e += ExactSum(x);
            s.add(ExactSum(-0x1p-72));
            e += ExactSum(-0x1p-72);
            CHECK(s.sum() == e);
        }
    }
}

TEST_CASE("many threads that add to the same sums lose nothing") {
    constexpr std::size_t kThreads = 4, kSums = 3, kTerms = 60000;
    std::vector<SharedSum> sums(kSums);
    std::vector<ExactSum> expected(kSums);
    std::vector<std::vector<ExactSum>> work;
    for (unsigned t = 0; t < kThreads; ++t) {
        work.push_back(terms(kTerms, t + 10));
        for (std::size_t i = 0; i < kTerms; ++i) expected[i % kSums] += work[t][i];
    }
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < kThreads; ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < kTerms; ++i) sums[i % kSums].add(work[t][i]);
        });
    for (std::thread& t : threads) t.join();
    for (std::size_t i = 0; i < kSums; ++i) CHECK(sums[i].sum() == expected[i]);
}

TEST_CASE("shared sums of parts add up") {
    SharedSum a, b, all;
    const auto list = terms(1000, 3);
    for (std::size_t i = 0; i < list.size(); ++i) {
        (i % 3 == 0 ? a : b).add(list[i]);
        all.add(list[i]);
    }
    a += b;
    CHECK(a == all);
    CHECK(a.value() == all.value());
}

} // namespace abbe::test

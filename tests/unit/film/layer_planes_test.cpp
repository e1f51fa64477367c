#include "film/layer_planes.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

namespace abbe::test {

namespace {

float sumOf(const std::vector<std::vector<float>>& parts, std::size_t i) {
    float total = 0;
    for (const auto& part : parts) total += part[i];
    return total;
}

} // namespace

TEST_CASE("rounded parts add up to the whole to the last bit, and move by no more than rounding") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> exponent(-12, 12), sign(-1, 1);
    for (const std::size_t count : {1u, 2u, 3u, 7u}) {
        constexpr std::size_t kValues = 20000;
        std::vector<float> whole(kValues);
        std::vector<std::vector<float>> parts(count, std::vector<float>(kValues));
        int unequal = 0;
        for (std::size_t i = 0; i < kValues; ++i) {
            double exact = 0;
            for (auto& part : parts) {
                // Also negative ones, as colours outside of the primaries are, and zeros.
                double v = std::exp2(exponent(random));
                if (i % 3 == 1) v *= sign(random);
                if (i % 5 == 0 && &part != &parts[0]) v = 0;
                exact += v;
                part[i] = static_cast<float>(v);
            }
            whole[i] = static_cast<float>(exact);
            unequal += sumOf(parts, i) != whole[i];
        }
        if (count > 2) CHECK(unequal > 1000);
        const auto before = parts;
        const std::vector<float> picture = whole;
        Partition partition(parts.begin(), parts.end());
        CHECK(roundToSum(whole, std::span(&partition, 1)) == 0);
        int changed = 0, changedInVain = 0;
        for (std::size_t i = 0; i < kValues; ++i) {
            REQUIRE(sumOf(parts, i) == whole[i]);
            float largest = std::abs(picture[i]);
            for (const auto& part : before) largest += std::abs(part[i]);
            for (std::size_t p = 0; p < count; ++p) REQUIRE(std::abs(parts[p][i] - before[p][i]) <= 1e-6f * largest);
            REQUIRE(std::abs(whole[i] - picture[i]) <= 3e-7f * largest);
            changed += whole[i] != picture[i];
            changedInVain += i % 3 != 1 && whole[i] != picture[i]; // nothing cancels
        }
        CHECK(changed < static_cast<int>(kValues) / 3);
        CHECK(changedInVain <= static_cast<int>(kValues) / 500);
    }
}

TEST_CASE("two partitions of one picture both add up to it, where parts cancel as well") {
    std::vector<float> a{1.f, 0.3f}, b{-0.9f, 0.1f}, c{0.1000001f, 0.25f}, d{1e-9f, 0.1500001f}, whole{0.1f, 0.4f};
    const Partition partitions[] = {{a, b}, {c, d}};
    CHECK(roundToSum(whole, partitions) == 0);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(a[i] + b[i] == whole[i]);
        CHECK(c[i] + d[i] == whole[i]);
    }
    CHECK(whole[1] == 0.4f);
    CHECK(whole[0] == doctest::Approx(0.1).epsilon(1e-5));
}

TEST_CASE("parts that are wrong are not made right") {
    std::vector<float> a{1, 2}, b{1, 2}, whole{2, 4.1f};
    const Partition parts{a, b};
    CHECK(roundToSum(whole, std::span(&parts, 1)) == 1);
    CHECK(a == std::vector<float>{1, 2});
    CHECK(b == std::vector<float>{1, 2});
    CHECK(whole[1] == 4.1f);
}

} // namespace abbe::test

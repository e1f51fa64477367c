// Permutations by hashing and the strata that are visited in their order.
#include "math/multi_jitter.h"
#include "support/chi_square.h"

#include <doctest/doctest.h>
#include <set>
#include <vector>

namespace abbe::test {

TEST_CASE("multi-jitter: every count is permuted") {
    for (const std::uint32_t count : {1u, 2u, 3u, 5u, 7u, 8u, 9u, 31u, 32u, 33u, 100u, 1000u})
        for (const std::uint64_t key : {0ull, 1ull, 77ull, 0xdeadbeefcafeull}) {
            std::set<std::uint32_t> seen;
            for (std::uint32_t i = 0; i < count; ++i) seen.insert(permuted(i, count, key));
            INFO("count " << count << ", key " << key);
            CHECK(seen.size() == count);
            CHECK(*seen.rbegin() == count - 1);
        }
    CHECK(permuted(0xfffffffeu, 0xffffffffu, 3) < 0xffffffffu);
}

TEST_CASE("multi-jitter: over keys each place is equally likely, and each pair of places") {
    for (const std::uint32_t count : {3u, 4u, 6u, 8u, 11u}) {
        std::vector<double> places(count), pairs(count * count);
        constexpr int keys = 40000;
        for (int k = 0; k < keys; ++k) {
            const std::uint64_t key = mix64(static_cast<std::uint64_t>(k) + 12345);
            const std::uint32_t a = permuted(0, count, key), b = permuted(count - 1, count, key);
            ++places[a];
            ++pairs[a * count + b];
        }
        INFO("count " << count);
        CHECK(chiSquareTest(places, std::vector<double>(count, keys / static_cast<double>(count))).pValue > 1e-4);
        std::vector<double> observed;
        for (std::uint32_t a = 0; a < count; ++a)
            for (std::uint32_t b = 0; b < count; ++b)
                if (a != b) observed.push_back(pairs[a * count + b]);
        CHECK(chiSquareTest(observed, std::vector<double>(observed.size(), keys / static_cast<double>(observed.size())))
                  .pValue > 1e-4);
    }
}

TEST_CASE("multi-jitter: one sample to a stratum, in each dimension and, for whole grids, in both") {
    for (const std::uint32_t count : {1u, 4u, 9u, 12u, 64u, 100u, 17u, 127u}) {
        const auto columns = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
        const std::uint32_t rows = (count + columns - 1) / columns;
        std::set<std::uint32_t> single, second, cells, first;
        for (std::uint32_t i = 0; i < count; ++i) {
            single.insert(static_cast<std::uint32_t>(static_cast<double>(jittered(i, count, 5)) * count));
            const Vec2 p = multiJittered(i, count, 9);
            second.insert(static_cast<std::uint32_t>(static_cast<double>(p.y) * count));
            first.insert(static_cast<std::uint32_t>(static_cast<double>(p.x) * columns * rows));
            cells.insert(static_cast<std::uint32_t>(p.x * static_cast<float>(columns)) * 1000 +
                         static_cast<std::uint32_t>(static_cast<double>(p.y) * count) / columns);
        }
        INFO("count " << count);
        CHECK(single.size() == count);
        CHECK(second.size() == count);
        CHECK(first.size() == count);
        CHECK(cells.size() == count);
    }
}

// Also the first few of many: a render that ends early has no other.
TEST_CASE("multi-jitter: every sample by itself is uniform on the square") {
    for (const std::uint32_t count : {2u, 7u, 12u, 64u})
        for (const std::uint32_t i : {0u, count - 1}) {
            std::vector<double> grid(36), line(20);
            constexpr int keys = 36000;
            for (int k = 0; k < keys; ++k) {
                const std::uint64_t key = mix64(static_cast<std::uint64_t>(k) * 3 + 1);
                const Vec2 p = multiJittered(i, count, key);
                ++grid[static_cast<std::size_t>(p.x * 6) * 6 + static_cast<std::size_t>(p.y * 6)];
                ++line[static_cast<std::size_t>(jittered(i, count, key) * 20)];
            }
            INFO("sample " << i << " of " << count);
            CHECK(chiSquareTest(grid, std::vector<double>(36, 1000)).pValue > 1e-4);
            CHECK(chiSquareTest(line, std::vector<double>(20, 1800)).pValue > 1e-4);
        }
}

} // namespace abbe::test

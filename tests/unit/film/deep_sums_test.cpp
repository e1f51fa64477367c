#include "film/deep_sums.h"

#include <algorithm>
#include <array>
#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

constexpr PixelBounds kBounds{-1, 3, 2, 5};

struct Event {
    std::size_t pixel;
    DeepSums::Kind kind;
    float depth, share;
    Xyz light;
};

std::vector<Event> events(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> real(0, 1);
    std::vector<Event> list;
    for (int i = 0; i < count; ++i) {
        const auto pixel = static_cast<std::size_t>(real(random) * 6);
        const auto kind = real(random) < 0.5 ? DeepSums::Kind::surface : DeepSums::Kind::medium;
        // Pixels reach less and less far, so that their lists are coarsened differently.
        const auto depth = static_cast<float>(std::exp((6 - static_cast<double>(pixel)) * real(random)));
        list.push_back({pixel,
                        kind,
                        depth,
                        static_cast<float>(real(random)),
                        {real(random), 10 * real(random) - 5, 1e-7 * real(random)}});
    }
    return list;
}

void add(DeepSums& sums, std::span<const Event> list) {
    for (const Event& e : list) sums.add(e.pixel, e.kind, e.depth, e.share, e.light);
}

std::vector<std::byte> bytesOf(DeepSums& sums, PixelBounds b = kBounds) {
    std::vector<std::byte> bytes;
    sums.plane()->store(b, bytes);
    return bytes;
}

} // namespace

TEST_CASE("deep sums are the same bits in any order of the samples") {
    auto list = events(3000, 7);
    DeepSums first(kBounds, 8);
    add(first, list);
    const auto wanted = bytesOf(first);
    for (unsigned seed = 0; seed < 5; ++seed) {
        std::shuffle(list.begin(), list.end(), std::mt19937(seed));
        DeepSums other(kBounds, 8);
        add(other, list);
        CHECK(bytesOf(other) == wanted);
    }
    std::uint32_t most = 0, least = 99;
    for (std::size_t pixel = 0; pixel < 6; ++pixel) {
        const auto& bins = first.bins(pixel, DeepSums::Kind::medium);
        CHECK(bins.list.size() <= 8);
        CHECK(bins.list.size() > 1);
        most = std::max(most, bins.level);
        least = std::min(least, bins.level);
    }
    CHECK(most > least);
}

TEST_CASE("deep sums of parts that are put together are those of the whole") {
    const auto list = events(2000, 11);
    DeepSums whole(kBounds, 5), a(kBounds, 5), b(kBounds, 5);
    add(whole, list);
    const std::span all(list);
    add(a, all.first(1900));
    add(b, all.subspan(1900)); // finer than the other
    for (const auto& order : {std::array{&b, &a}, {&a, &b}}) {
        DeepSums together(kBounds, 5);
        for (DeepSums* part : order)
            for (int y = kBounds.y0; y < kBounds.y1; ++y) { // by rows, as tiles are
                const PixelBounds row{kBounds.x0, y, kBounds.x1, y + 1};
                REQUIRE(together.plane()->add(row, bytesOf(*part, row)));
            }
        CHECK(bytesOf(together) == bytesOf(whole));
    }
    DeepSums other(kBounds, 6);
    CHECK(other.plane()->name() != whole.plane()->name());
}

TEST_CASE("a bin holds its distances, its shares and its light") {
    DeepSums sums({0, 0, 1, 1}, 64);
    using Kind = DeepSums::Kind;
    sums.add(0, Kind::surface, 2.5f, 1, {1, 2, 3});
    sums.add(0, Kind::surface, 2.5001f, 0.5f, {1, 2, 3});
    sums.add(0, Kind::surface, 3, 1, {});
    sums.add(0, Kind::medium, 0, 1, {}); // on the lens
    sums.add(0, Kind::medium, 3e38f, 1, {});
    const auto& surfaces = sums.bins(0, Kind::surface);
    REQUIRE(surfaces.list.size() == 2);
    CHECK(surfaces.level == 0);
    CHECK(surfaces.list[0].share.value() == 1.5);
    CHECK(surfaces.list[0].y.value() == 4);
    CHECK(surfaces.list[0].depth.value() == doctest::Approx(2.5 + 0.5 * 2.5001).epsilon(1e-7));
    CHECK(surfaces.front(0) <= 2.5f);
    CHECK(surfaces.back(0) > 2.5001f);
    CHECK(surfaces.back(0) < 2.5f * (1 + 1.f / 32));
    const auto& media = sums.bins(0, Kind::medium);
    REQUIRE(media.list.size() == 2);
    CHECK(media.front(0) == 0);
    CHECK(media.back(1) >= 3e38f);
}

TEST_CASE("bytes that are no deep sums are refused and nothing is added") {
    DeepSums sums(kBounds, 8);
    add(sums, events(200, 3));
    const auto sound = bytesOf(sums);
    DeepSums empty(kBounds, 8);
    const auto nothing = bytesOf(empty);
    const auto refused = [&](std::vector<std::byte> bytes) {
        const bool refusal = !empty.plane()->add(kBounds, bytes);
        return refusal && bytesOf(empty) == nothing;
    };
    CHECK(refused({sound.begin(), sound.end() - 4}));
    auto longer = sound;
    longer.resize(longer.size() + 8);
    CHECK(refused(longer));
    auto level = sound;
    level[0] = std::byte{15};
    CHECK(refused(level));
    auto count = sound;
    count[4] = std::byte{9};
    CHECK(refused(count));
    auto order = sound; // the second key before the first
    for (std::size_t i = 0; i < 4; ++i) order[8 + 84 + i] = std::byte{0};
    CHECK(refused(order));
    CHECK(empty.plane()->add(kBounds, sound));
}

#include "volumes/brick_tree_builder.h"
#include "volumes/noise_field.h"

#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

class Field final : public PointField {
  public:
    float (*value)(Vec3d) = nullptr;
    FieldBounds (*known)(const Bounds3d&) = nullptr;
    float at(Vec3d p) const noexcept override { return value(p); }
    FieldBounds limits(const Bounds3d& region) const override { return known(region); }
};

FieldBounds zeroToOne(const Bounds3d&) { return {0, 0.5f, 1}; }

} // namespace

TEST_CASE("sampled bounds: where the limits say that a field is constant, it is so exactly, in one node") {
    Field field;
    field.value = [](Vec3d) { return 0.3f; };
    field.known = [](const Bounds3d&) { return FieldBounds{0.3f, 0.3f, 0.3f}; };
    const BrickBounds bounds = sampleBounds(field, {8, 8, 8});
    CHECK(bounds.brickCount() == 0);
    CHECK(bounds.at({3, 60, 9}).minimum == 0.3f);
    CHECK(bounds.at({3, 60, 9}).maximum == 0.3f);
    CHECK(bounds.at({3, 64.5f, 9}).maximum == 0);
    field.known = [](const Bounds3d&) { return FieldBounds{}; };
    CHECK(sampleBounds(field, {9, 2, 3}).empty());
}

TEST_CASE("sampled bounds: near the extremes of a smooth field, beyond them, and within the limits") {
    Field field;
    field.value = [](Vec3d p) { return static_cast<float>(p.x / 80); };
    field.known = zeroToOne;
    const BrickBounds bounds = sampleBounds(field, {10, 3, 1});
    CHECK(bounds.brickCount() == 30);
    for (int brick = 0; brick < 10; ++brick) {
        const FieldBounds b = bounds.at({static_cast<float>(8 * brick + 4), 12, 4});
        const float low = 0.1f * static_cast<float>(brick), high = low + 0.1f;
        CHECK(b.minimum <= low);
        CHECK(b.minimum >= std::max(0.f, low - 0.03f));
        CHECK(b.maximum >= high);
        CHECK(b.maximum <= std::min(1.f, high + 0.03f));
        CHECK(b.mean == doctest::Approx(low + 0.05f).epsilon(0.02));
    }
}

TEST_CASE("sampled bounds: what no sample met still has a chance") {
    Field field;
    field.value = [](Vec3d p) { return length(p - Vec3d(4, 4, 3.03)) < 0.02 ? 1.f : 0.f; };
    field.known = zeroToOne;
    const FieldBounds b = sampleBounds(field, {1, 1, 1}).at({4, 4, 4});
    CHECK(b.maximum > 0);
    CHECK(b.maximum < 0.05f);
    field.value = [](Vec3d p) { return length(p - Vec3d(4, 4, 3.03)) < 0.02 ? 0.f : 1.f; };
    const FieldBounds full = sampleBounds(field, {1, 1, 1}).at({4, 4, 4});
    CHECK(full.maximum == 1);
    CHECK(full.minimum < 1);
}

TEST_CASE("noise: constant without contrast, in the share of space that was asked for, the same far away") {
    NoisePattern pattern;
    pattern.contrast = 0;
    const NoiseField flat(pattern);
    CHECK(flat.at({0.3, -7, 1e8}) == 1);
    CHECK(flat.mean() == 1);
    for (const NoiseKind kind : {NoiseKind::gradient, NoiseKind::billow, NoiseKind::cellular})
        for (const double coverage : {0.05, 0.5, 1.0})
            for (const double warp : {0.0, 0.7}) {
                pattern = {};
                pattern.kind = kind;
                pattern.coverage = coverage;
                pattern.warp = warp;
                pattern.scale = 0.3;
                const NoiseField field(pattern);
                pattern.seed = 1;
                const NoiseField other(pattern);
                std::mt19937 random(7);
                std::uniform_real_distribution<double> within(-1e4, 1e4);
                int filled = 0, differ = 0;
                double sum = 0;
                constexpr int n = 20'000;
                for (int i = 0; i < n; ++i) {
                    const Vec3d p(within(random), within(random), within(random));
                    const float v = field.at(p);
                    REQUIRE((v >= 0 && v <= 1));
                    filled += v > 0;
                    differ += v != other.at(p);
                    sum += static_cast<double>(v);
                }
                CHECK(static_cast<double>(filled) / n == doctest::Approx(coverage).epsilon(0.12));
                CHECK(sum / n == doctest::Approx(static_cast<double>(field.mean())).epsilon(0.12));
                CHECK(differ > n * coverage * 0.5);
                for (const double far : {1e12, 1e30, 1e300}) CHECK(std::isfinite(field.at({far, -far, 0})));
            }
    pattern = {};
    pattern.contrast = 0.25;
    CHECK(NoiseField(pattern).minimum() == 0.75f);
}

TEST_CASE("noise: continuous, also far from the origin") {
    NoisePattern pattern;
    pattern.octaves = 4;
    const NoiseField field(pattern);
    for (const double far : {0.0, 1e9}) {
        float last = field.at({far, 0.5, 0.5}), most = 0;
        for (int i = 1; i <= 4000; ++i) {
            const float v = field.at({far + i * 1e-3, 0.5, 0.5});
            CHECK(std::abs(v - last) < 0.05f);
            most = std::max(most, std::abs(v - last));
            last = v;
        }
        CHECK(most > 1e-4f);
    }
}

// The GGX distribution against double precision, and its two samplers by their Jacobians.
#include "materials/ggx.h"
#include "support/ggx_reference.h"
#include "support/jacobian.h"
#include "support/quadrature.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

Vec3 direction(test::Random& random) {
    const float z = random.uniform(), phi = 2 * kPi * random.uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

TEST_CASE("D keeps its digits down to the sharpest lobes (case 24)") {
    test::Random random(1);
    for (const float alpha : {1e-4f, 1e-3f, 1e-2f, 0.1f, 0.5f, 1.f})
        for (int i = 0; i < 1000; ++i) {
            const float slope = alpha * 5 * random.uniform(), phi = 2 * kPi * random.uniform();
            const Vec3 m = normalize(Vec3{slope * std::cos(phi), slope * std::sin(phi), 1});
            const float alphaY = i % 2 ? alpha : std::min(1.f, 3 * alpha);
            const double expected = test::ReferenceGgx{alpha, alphaY}.D(Vec3d(m));
            CHECK(std::abs(Ggx(alpha, alphaY).D(m) / expected - 1) < 1e-6);
        }
}

TEST_CASE("D is normalised: the projected normals fill the plane") {
    for (const float alpha : {0.05f, 0.3f, 1.f}) {
        const Ggx ggx(alpha, 0.5f * alpha);
        // Over slopes: D cos^4 is the density of (x, y) = -(m.x, m.y)/m.z; mapped from polar coordinates r = tan t.
        const double total = test::integrate2(
            [&](double t, double phi) {
                const double r = std::tan(t), x = r * std::cos(phi) * alpha, y = r * std::sin(phi) * alpha;
                const Vec3d m = normalize(Vec3d{x, y, 1});
                return ggx.D(Vec3(m)) * std::pow(m.z, 4) * r * (1 + r * r) * alpha * alpha;
            },
            0, kPiD / 2 - 1e-4, 0, 2 * kPiD, 64, 16);
        CHECK(total == doctest::Approx(1).epsilon(1e-5));
    }
}

TEST_CASE("masking terms are Smith's") {
    test::Random random(2);
    const Ggx ggx(0.4f, 0.1f);
    const test::ReferenceGgx reference{0.4f, 0.1f};
    for (int i = 0; i < 1000; ++i) {
        const Vec3 wo = direction(random), wi = direction(random);
        CHECK(ggx.visible(wo) * wo.z == doctest::Approx(reference.G1(Vec3d(wo))).epsilon(1e-5));
        CHECK(ggx.maskingOverCosine(wo, wi) * wo.z ==
              doctest::Approx(reference.G2(Vec3d(wo), Vec3d(wi))).epsilon(1e-5));
    }
}

TEST_CASE("sampled normals have the stated density") {
    test::Random random(3);
    for (const auto& [alphaX, alphaY] :
         {std::pair(0.05f, 0.05f), {0.3f, 0.3f}, {1.f, 1.f}, {0.5f, 0.05f}, {1.4f, 0.4f}}) {
        const Ggx ggx(alphaX, alphaY);
        test::Moments plain, bounded;
        for (int i = 0; i < 3000; ++i) {
            const Vec3 wo = direction(random);
            const Vec2 u{0.01f + 0.98f * random.uniform(), 0.01f + 0.98f * random.uniform()};
            const Vec3 m = ggx.sampleVisible(wo, u);
            const auto j = test::jacobian([&](Vec2 v) { return std::optional(ggx.sampleVisible(wo, v)); }, u, 2e-3f);
            plain.add(*j * ggx.visible(wo) * ggx.D(m) * dot(wo, m));
            const Vec3 wi = reflect(wo, ggx.sampleBounded(wo, u));
            const auto k =
                test::jacobian([&](Vec2 v) { return std::optional(reflect(wo, ggx.sampleBounded(wo, v))); }, u, 2e-3f);
            if (wi.z > 0) bounded.add(*k * ggx.boundedReflection(wo) * ggx.D(normalize(wo + wi)));
        }
        CHECK(plain.mean() == doctest::Approx(1).epsilon(3e-3));
        CHECK(bounded.mean() == doctest::Approx(1).epsilon(3e-3));
    }
}

TEST_CASE("the bounded cap loses few directions below the horizon") {
    test::Random random(4);
    const Ggx ggx(1, 1);
    int lost = 0, lostBounded = 0;
    for (int i = 0; i < 10000; ++i) {
        const Vec3 wo{0.3f, 0, std::sqrt(1 - 0.09f)};
        const Vec2 u{random.uniform(), random.uniform()};
        lost += reflect(wo, ggx.sampleVisible(wo, u)).z <= 0;
        lostBounded += reflect(wo, ggx.sampleBounded(wo, u)).z <= 0;
    }
    CHECK(lost > 3500);
    CHECK(lostBounded < 1000);
}

TEST_CASE("widths from roughness: limits and anisotropy (case 25)") {
    CHECK(Ggx::fromRoughness(0, 0).smooth());
    CHECK(Ggx::fromRoughness(0.0223f, 0).smooth());
    CHECK(!Ggx::fromRoughness(0.0225f, 0).smooth());
    CHECK(Ggx::fromRoughness(0.5f, 0).alphaX() == doctest::Approx(0.25));
    const Ggx stretched = Ggx::fromRoughness(0.5f, 0.75f);
    CHECK(stretched.alphaY() == doctest::Approx(0.25f * stretched.alphaX()));
    CHECK(square(stretched.alphaX()) + square(stretched.alphaY()) == doctest::Approx(2 * 0.0625));
    const Ggx thread = Ggx::fromRoughness(0.5f, 1); // one width is 0
    CHECK(!thread.smooth());
    CHECK(thread.alphaY() == Ggx::kSharpest);
    CHECK(std::isfinite(thread.D({0, 0, 1})));
}

} // namespace
} // namespace abbe

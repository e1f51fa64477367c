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

// The tables of single-scattering albedo against their integrals, recomputed at random nodes and between them.
namespace {

struct Point {
    double mu, alpha;
};

// Half of the points near grazing incidence in units of α, where the loss is.
Point randomPoint(test::Random& random, int i) {
    const double roughness = 0.0224 + 0.9776 * random.uniformDouble(), alpha = roughness * roughness;
    const double mu = random.uniformDouble();
    return {std::max(1e-4, i % 2 ? mu : std::min(1.0, 3 * alpha * mu)), alpha};
}

// Interpolation is worst at the cusps at grazing incidence and at the critical angle of very rough surfaces.
TEST_CASE("mirror: between nodes the table is right to 1.5e-3, within a degree of grazing to 6e-3" *
          doctest::test_suite("sweep")) {
    test::Random random(1);
    test::Moments all;
    for (int i = 0; i < 400; ++i) {
        const auto [mu, alpha] = randomPoint(random, i);
        const double expected = test::referenceAlbedo(mu, alpha);
        const double error = ggxAlbedo(static_cast<float>(mu), static_cast<float>(alpha)) / expected - 1;
        CHECK(std::abs(error) < (mu > 0.02 ? 1.5e-3 : 6e-3));
        all.add(std::abs(error));
    }
    CHECK(all.mean() < 3e-4);
}

TEST_CASE("interface: between nodes the table is right to 3e-3 for indices from 1.1 to 2.6, both sides" *
          doctest::test_suite("sweep")) {
    test::Random random(2);
    test::Moments all;
    for (int i = 0; i < 400; ++i) {
        const auto [mu, alpha] = randomPoint(random, i);
        const double index = 1.1 + 1.5 * random.uniformDouble(), eta = i % 4 < 2 ? index : 1 / index;
        const test::ReferenceInterface once = test::referenceInterface(mu, alpha, eta);
        const InterfaceShares<float> shares =
            ggxInterface(static_cast<float>(mu), static_cast<float>(alpha), static_cast<float>(eta));
        const double error = once.reflected * static_cast<double>(shares.reflection()) +
                             once.transmitted * static_cast<double>(shares.transmission()) - 1;
        CHECK(std::abs(error) < (mu > 0.02 ? 3e-3 : 6e-3));
        all.add(std::abs(error));
    }
    CHECK(all.mean() < 3e-4);
}

TEST_CASE("limits: smooth surfaces and grazing angles keep everything, the ends of the tables are finite") {
    CHECK(ggxAlbedo(1, 1e-4f) == doctest::Approx(1).epsilon(1e-4));
    CHECK(ggxAlbedo(0, 0.3f) == doctest::Approx(1).epsilon(1e-4));
    CHECK(ggxAlbedo(1, 1) == doctest::Approx(0.3069).epsilon(2e-3)); // 1 - ln 2
    for (const float mu : {0.f, 1e-30f, 0.5f, 1.f})
        for (const float alpha : {0.f, 1e-4f, 0.5f, 1.f})
            for (const float eta : {0.2f, 0.5f, 0.9999f, 1.f, 1.0001f, 1.5f, 4.f, 10.f}) {
                const InterfaceShares<float> shares = ggxInterface(mu, alpha, eta);
                CHECK(shares.turned > 0);
                CHECK(shares.turned < 1);
                CHECK(shares.kept >= 0.001f); // nearly index-matched, grazing light is stopped either way
                CHECK(shares.kept < 1.01f);
            }
}

} // namespace
} // namespace abbe

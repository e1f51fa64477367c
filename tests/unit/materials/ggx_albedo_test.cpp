// The tables of single-scattering albedo against their integrals, recomputed at random nodes and between them.
#include "materials/ggx_albedo.h"
#include "support/ggx_reference.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
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
TEST_CASE("mirror: between nodes the table is right to 1.5e-3, within a degree of grazing to 6e-3") {
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

TEST_CASE("interface: between nodes the table is right to 3e-3 for indices from 1.1 to 2.6, both sides") {
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

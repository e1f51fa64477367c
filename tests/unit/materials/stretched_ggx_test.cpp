// The albedo of stretched rough mirrors against its integral in double precision.
#include "materials/ggx.h"
#include "materials/stretched_ggx.h"
#include "support/ggx_reference.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

double expected(Vec3d wo, double alphaX, double alphaY) {
    const test::ReferenceGgx ggx{alphaX, alphaY};
    constexpr int count = 28657, step = 17711; // Fibonacci numbers 23 and 22
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count, u = std::fmod((i + 0.5) * step / count, 1.0);
        const Vec3d m = ggx.visibleNormal(wo, u, 1 - (1 - t) * (1 - t) * (1 - t));
        const Vec3d wi = m * (2 * dot(wo, m)) - wo;
        if (wi.z > 0) sum += 3 * (1 - t) * (1 - t) * ggx.G2(wo, wi) / ggx.G1(wo);
    }
    return sum / count;
}

TEST_CASE("stretched mirror: between nodes the table is right to 3e-3, within a degree of grazing to 1e-2" *
          doctest::test_suite("sweep")) {
    test::Random random(5);
    test::Moments all;
    for (const auto& [x, y] :
         {std::pair{1.2f, 0.4f}, {0.6f, 0.2f}, {0.3f, 0.3f}, {0.1f, 0.9f}, {1.3f, 0.02f}, {0.05f, 0.01f}}) {
        const StretchedAlbedo table(x, y);
        double worst = 0;
        for (int i = 0; i < 60; ++i) {
            const double mu = std::max(1e-3, i % 2 ? random.uniformDouble() : 0.5 * square(random.uniformDouble()));
            const double phi = 2 * kPiD * random.uniformDouble(), sine = std::sqrt(1 - mu * mu);
            const Vec3d wo{sine * std::cos(phi), sine * std::sin(phi), mu};
            const double error = static_cast<double>(table(Vec3(wo))) / expected(wo, x, y) - 1;
            CHECK(std::abs(error) < (mu > 0.02 ? 3e-3 : 1e-2));
            worst = std::max(worst, std::abs(error));
            all.add(std::abs(error));
        }
        MESSAGE("widths ", x, " ", y, ": largest error ", worst);
    }
    CHECK(all.mean() < 1e-3);
}

TEST_CASE("stretched mirror: equal widths meet the table of round ones, swapped widths swap the axes") {
    const StretchedAlbedo round(0.5f, 0.5f), a(0.7f, 0.1f), b(0.1f, 0.7f);
    for (const float mu : {0.01f, 0.1f, 0.5f, 1.f}) {
        const float sine = std::sqrt(1 - mu * mu);
        CHECK(round({0, sine, mu}) == doctest::Approx(ggxAlbedo(mu, 0.5f)).epsilon(3e-3));
        CHECK(a({0.6f * sine, 0.8f * sine, mu}) == doctest::Approx(b({-0.8f * sine, 0.6f * sine, mu})).epsilon(2e-3));
    }
}

} // namespace
} // namespace abbe

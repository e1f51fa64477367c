// The energy-preserving Oren-Nayar model: furnace, albedo, reciprocity, Lambert's limit.
#include "materials/eon_diffuse.h"
#include "math/warp.h"
#include "support/quadrature.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

Vec3 at(double z, double phi) {
    const double r = std::sqrt(1 - z * z);
    return Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z});
}

double albedo(const EonDiffuse& eon, double mu) {
    const Vec3 wo = at(mu, 0.3);
    return test::integrate2([&](double z, double phi) { return z * static_cast<double>(eon(wo, at(z, phi))[0]); }, 0, 1,
                            0, 2 * kPiD, 48, 48);
}

TEST_CASE("white keeps all light at every roughness and angle") {
    for (const float roughness : {0.f, 0.05f, 0.3f, 0.6f, 1.f})
        for (const double mu : {1e-4, 0.01, 0.1, 0.4, 0.8, 1.0})
            CHECK(albedo(EonDiffuse(Spectrum(1.f), roughness), mu) == doctest::Approx(1).epsilon(1e-4));
}

TEST_CASE("the stated albedo is the integral, and colour deepens with roughness") {
    for (const float rho : {0.1f, 0.5f, 0.9f}) {
        double previous = 1;
        for (const float roughness : {0.f, 0.3f, 1.f}) {
            const EonDiffuse eon(Spectrum(rho), roughness);
            for (const double mu : {0.01, 0.3, 0.9})
                CHECK(albedo(eon, mu) == doctest::Approx(eon.albedo(static_cast<float>(mu))[0]).epsilon(2e-4));
            const double normal = static_cast<double>(eon.albedo(1)[0]);
            CHECK(normal < previous);
            previous = normal;
        }
    }
}

TEST_CASE("reciprocal, finite at the horizon, and Lambert's at roughness 0") {
    test::Random random(5);
    const EonDiffuse eon(Spectrum(0.7f), 0.8f);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 a = squareToCosineHemisphere({random.uniform(), random.uniform()});
        const Vec3 b = squareToCosineHemisphere({random.uniform(), random.uniform()});
        CHECK(eon(a, b)[0] == doctest::Approx(eon(b, a)[0]).epsilon(1e-5));
    }
    for (const float z : {1e-38f, 1e-20f, 1e-6f})
        for (const float other : {1e-38f, 0.5f, 1.f}) {
            const float f = eon(at(static_cast<double>(z), 0), at(static_cast<double>(other), 2))[0];
            CHECK(std::isfinite(f));
            CHECK(f >= 0);
        }
    CHECK(EonDiffuse(Spectrum(0.7f), 0)(at(0.2, 0), at(0.9, 1))[0] == doctest::Approx(0.7 / kPiD));
    CHECK(EonDiffuse(Spectrum(0.7f), 1e-4f)(at(0.2, 0), at(0.9, 1))[0] == doctest::Approx(0.7 / kPiD).epsilon(1e-3));
}

} // namespace
} // namespace abbe

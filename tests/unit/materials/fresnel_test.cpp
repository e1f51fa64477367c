// Fresnel's reflectance against double and long double (docs/hard_cases.md, cases 28 and 29).
#include "materials/fresnel.h"
#include "support/ggx_reference.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

TEST_CASE("dielectric: eta near 1 and angles near the critical one keep their digits") {
    double worst = 0;
    for (const double delta : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.33, 0.5, 1.4})
        for (const double sign : {-1.0, 1.0}) {
            const float eta = static_cast<float>(sign > 0 ? 1 + delta : 1 / (1 + delta));
            const double critical = eta < 1 ? std::sqrt(1 - static_cast<double>(eta) * eta) : 0.1;
            for (int i = 0; i <= 2000; ++i) {
                const float c = static_cast<float>(std::min(1.0, i <= 1000 ? i / 1000.0 : critical * i / 1500.0));
                const double expected = test::referenceFresnel(c, static_cast<double>(eta));
                const double error = std::abs(fresnelDielectric(c, Spectrum(eta))[3] - expected);
                worst = std::max(worst, error);
                CHECK(fresnelDielectric(c, eta) == fresnelDielectric(c, Spectrum(eta))[7]);
            }
        }
    CHECK(worst < 1e-5);
}

TEST_CASE("dielectric: no interface reflects nothing, grazing light is reflected, lanes are independent") {
    CHECK(fresnelDielectric(0.5f, Spectrum(1.f))[0] == 0);
    CHECK(fresnelDielectric(0.f, Spectrum(1.f))[0] == 0);
    CHECK(fresnelDielectric(0.f, Spectrum(1.5f))[0] == doctest::Approx(1));
    CHECK(fresnelDielectric(1.f, Spectrum(1.5f))[0] == doctest::Approx(0.04));
    CHECK(fresnelDielectric(0.5f, Spectrum(1 / 1.5f))[0] == 1); // beyond the critical angle
    const Spectrum lanes = fresnelDielectric(0.7f, Spectrum(Float8{1, 1.2f, 1.5f, 2, 0.5f, 0.8f, 1.01f, 3}));
    CHECK(lanes[2] == fresnelDielectric(0.7f, Spectrum(1.5f))[0]);
    CHECK(lanes[4] == 1);
    CHECK(allFinite(fresnelDielectric(0.f, Spectrum(Float8{1, 1.0000001f, 0.9999999f, 2, 0.5f, 1e-3f, 1e3f, 3}))));
}

TEST_CASE("conductor: k near 0, k huge and measured metals agree with long double") {
    test::Random random(5);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const float n = static_cast<float>(std::pow(10, -2 + 3 * random.uniformDouble()));
        const float k = static_cast<float>(std::pow(10, -8 + 13 * random.uniformDouble()));
        const float c = i % 7 ? random.uniform() : i % 2 ? 0.f : 1.f;
        const double expected =
            test::referenceFresnel(static_cast<double>(c), static_cast<double>(n), static_cast<double>(k));
        worst = std::max(worst, std::abs(fresnelConductor(c, Spectrum(n), Spectrum(k))[5] - expected));
    }
    CHECK(worst < 1e-5);
    CHECK(fresnelConductor(1, Spectrum(1.f), Spectrum(0.f))[0] < 1e-10f); // air in air
    CHECK(fresnelConductor(0.3f, Spectrum(0.f), Spectrum(3.f))[0] == 1);  // no loss at all
    CHECK(fresnelConductor(0, Spectrum(0.2f), Spectrum(3.f))[0] == doctest::Approx(1));
    CHECK(allFinite(fresnelConductor(0, Spectrum(Float8{0, 0, 1, 1, 0, 1e9f, 1, 1e-20f}),
                                     Spectrum(Float8{0, 1, 0, 1e9f, 1e9f, 0, 1e-20f, 1e-20f}))));
}

TEST_CASE("a dielectric is a conductor without k") {
    for (const float c : {0.f, 0.1f, 0.5f, 0.9f, 1.f})
        CHECK(fresnelConductor(c, Spectrum(1.5f), Spectrum(0.f))[0] ==
              doctest::Approx(fresnelDielectric(c, 1.5f)).epsilon(1e-5));
}

} // namespace
} // namespace abbe

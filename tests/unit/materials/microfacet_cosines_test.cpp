// The tables of microfacet angles: albedos of lobes with any Fresnel reflectance, against their integrals.
#include "materials/fresnel.h"
#include "materials/ggx_albedo.h"
#include "materials/microfacet_cosines.h"
#include "materials/openpbr_interface.h"
#include "materials/stretched_albedo.h"
#include "materials/stretched_interface.h"
#include "materials/stretched_lobe.h"
#include "support/microfacet_reference.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

double dot8(Spectrum a) { return static_cast<double>(sum(a * Spectrum(kCosineWeights))); }

TEST_CASE("the weights are those of the Gauss-Legendre rule that the nodes were taken at") {
    const test::GaussLegendre<8> rule;
    for (int i = 0; i < kLanes; ++i)
        CHECK(kCosineWeights[i] == doctest::Approx(rule.weight[static_cast<std::size_t>(i)]).epsilon(1e-6));
}

TEST_CASE("albedo of dielectric lobes to 3e-3") {
    test::Random random(3);
    test::Moments all;
    for (int i = 0; i < 240; ++i) {
        const double roughness = 0.0224 + 0.9776 * random.uniformDouble(), alpha = roughness * roughness;
        const double u = random.uniformDouble(), mu = std::max(1e-3, i % 2 ? u : std::min(1.0, 3 * alpha * u));
        const double eta = i % 3 == 0 ? 1.1 : i % 3 == 1 ? 1.5 : 2.4;
        const auto a = static_cast<float>(alpha), m = static_cast<float>(mu);
        const double expected =
            test::referenceReflection(mu, alpha, [&](double c) { return test::referenceFresnel(c, eta); });
        const Spectrum reflectance = fresnelDielectric(microfacetCosines(m, a), Spectrum(static_cast<float>(eta)));
        const double error = std::abs(static_cast<double>(ggxAlbedo(m, a)) * dot8(reflectance) - expected);
        CHECK(error < 4e-3);
        all.add(error);
    }
    CHECK(all.mean() < 3e-4);
}

TEST_CASE("a smooth surface has one angle") {
    for (const float mu : {0.1f, 0.3f, 1.f}) {
        const Spectrum c = microfacetCosines(mu, 0);
        for (int i = 0; i < kLanes; ++i) CHECK(std::abs(c[i] - mu) < 2e-3f);
    }
}

TEST_CASE("stretched lobes: round ones as a special case, the mirror's albedo as in its own table") {
    const StretchedLobe round(0.25f, 0.25f), stretched(0.5f, 0.1f);
    const StretchedAlbedo albedo(0.5f, 0.1f);
    for (const float mu : {0.05f, 0.3f, 0.9f})
        for (const float phi : {0.f, 0.7f, 1.5f}) {
            const float r = std::sqrt(1 - mu * mu);
            const Vec3 wo{r * std::cos(phi), r * std::sin(phi), mu};
            const Spectrum eta(1.5f);
            CHECK(dot8(fresnelDielectric(round.cosines(wo), eta)) ==
                  doctest::Approx(dot8(fresnelDielectric(microfacetCosines(mu, 0.25f), eta))).epsilon(0.01));
            CHECK(stretched.mirrorAlbedo(wo) == doctest::Approx(albedo(wo)).epsilon(1e-4));
        }
}

TEST_CASE("stretched interfaces: round ones as a special case") {
    const StretchedInterface round(0.25f, 0.25f, 1.5f);
    for (const float mu : {0.05f, 0.3f, 0.7f, 0.95f})
        for (const float phi : {0.f, 0.7f, 1.5f}) {
            const float r = std::sqrt(1 - mu * mu), x = r * std::cos(phi), y = r * std::sin(phi);
            for (const bool within : {false, true}) {
                const auto shares = ggxInterface(mu, 0.25f, within ? 1 / 1.5f : 1.5f);
                const auto [reflected, transmitted] = round({x, y, mu}, within);
                CHECK(2 * (shares.turned * reflected + (1 - shares.turned) * transmitted) ==
                      doctest::Approx(shares.kept).epsilon(4e-3));
            }
        }
}

TEST_CASE("hemispherical reflectance is the mean over the hemisphere") {
    for (const double n : {1.0, 1.01, 1.33, 1.5, 2.4, 4.0, 0.75}) {
        const double expected =
            test::integrate([&](double t) { return 2 * t * t * t * 2 * test::referenceFresnel(t * t, n); }, 0, 1, 256);
        CHECK(hemisphericalReflectance(n) == doctest::Approx(expected).epsilon(2e-3));
    }
}

} // namespace
} // namespace abbe

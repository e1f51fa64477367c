// The tables of microfacet angles: albedos of lobes with any Fresnel reflectance, against their integrals.
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/microfacet_cosines.h"
#include "materials/openpbr_interface.h"
#include "materials/stretched_ggx.h"
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

// What microfacets stop of the light that others turn, against sums over visible microfacets.
namespace {

// Share that is not stopped of the light from wo, reflected or refracted by microfacet m, with a weight of each; 0 if
// it cannot refract.
double escaping(const Ggx& ggx, Vec3 wo, Vec3 m, float eta, double reflection, double refraction) {
    const float c = dot(wo, m), g2 = (eta - 1) * (eta + 1) + c * c;
    if (!(g2 > 0)) return 0;
    const Vec3 back = reflect(wo, m), through = (m * (c - std::sqrt(g2)) - wo) * (1 / eta);
    const auto kept = [&](float masking) { return static_cast<double>(masking / ggx.visible(wo)); };
    return reflection * (back.z > 0 ? kept(ggx.maskingOverCosine(wo, back)) : 0) +
           refraction * (through.z < 0 ? kept(ggx.maskingOverCosine(wo, through)) : 0);
}

TEST_CASE("microfacets stop what is reflected and refracted as they do one by one") {
    test::Random random(5);
    for (int i = 0; i < 24; ++i) {
        const float width = 0.1f + 0.9f * random.uniform(), other = i % 2 ? width : 0.3f * width;
        const Ggx ggx(width, other);
        const float mu = 0.03f + 0.97f * random.uniform(), sine = std::sqrt(1 - mu * mu), phi = 6 * random.uniform();
        const Vec3 wo{sine * std::cos(phi), sine * std::sin(phi), mu};
        const float index = i % 3 == 0 ? 1.1f : 1.6f, eta = i % 4 < 2 ? index : 1 / index;
        const auto weight = [](double c) { return 1 - 0.5 * c; };
        const double back = i % 5 < 2, through = 1 - back;
        double expected = 0, got = 0;
        constexpr int count = 20000, steps = 2000;
        for (int k = 0; k < count; ++k) {
            const double u = std::fmod((k + 0.5) * 0.6180339887498949, 1.0), v = (k + 0.5) / count;
            const Vec3 m = ggx.sampleVisible(wo, {static_cast<float>(u), static_cast<float>(v)});
            if (const float c = dot(wo, m); c > 0)
                expected += weight(static_cast<double>(c)) * escaping(ggx, wo, m, eta, back, through) / count;
        }
        const MicrofacetEscape escape(ggx, wo, Spectrum(eta));
        for (int k = 0; k < steps; ++k) {
            const double c = (k + 0.5) / steps;
            const MicrofacetEscape::Shares kept = escape(Spectrum(static_cast<float>(c)));
            got += weight(c) *
                   (back * static_cast<double>(kept.reflected[0]) + through * static_cast<double>(kept.refracted[0])) /
                   steps;
        }
        CHECK_MESSAGE(std::abs(got - expected) < 1e-3, "widths ", width, " ", other, " mu ", mu, " eta ", eta, ": ",
                      got, " instead of ", expected);
    }
}

} // namespace
} // namespace abbe

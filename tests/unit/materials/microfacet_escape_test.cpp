// What microfacets stop of the light that others turn, against sums over visible microfacets.
#include "materials/microfacet_escape.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
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

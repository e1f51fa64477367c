// Masking and shadowing of transmission, and the light that rough glass turns after any number of events
// (docs/decisions/031-masking-of-transmission.md).
#include "materials/ggx.h"
#include "support/microfacet_walk.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

// G2 of light that passes, exact for Smith's heights: B(1 + Λo, 1 + Λi) [Heitz2016a]. Who is high above the others sees
// little of the other side.
double exactPassing(double lambdaO, double lambdaI) {
    return std::exp(std::lgamma(1 + lambdaO) + std::lgamma(1 + lambdaI) - std::lgamma(2 + lambdaO + lambdaI));
}

// The walk itself: its first event against closed forms, and its energy.
TEST_CASE("a walk among microfacets: reflection is masked as tabulated, transmission exactly; nothing is lost") {
    for (const double alpha : {0.2, 1.0})
        for (const double mu : {0.1, 0.6})
            for (const double eta : {1.5, 1 / 1.5}) {
                const test::WalkShares walk = test::MicrofacetWalk(mu, alpha, eta)(10000, 3);
                CHECK(walk.reflected + walk.transmitted == doctest::Approx(1).epsilon(5e-3));
                const test::ReferenceInterface once = test::referenceInterface(mu, alpha, eta);
                CHECK(walk.firstReflected == doctest::Approx(once.reflected).epsilon(0.01));
                const test::ReferenceGgx ggx{alpha, alpha};
                const Vec3d wo{std::sqrt(1 - mu * mu), 0, mu};
                const double exact = test::meanOverVisible(ggx, wo, [&](Vec3d m) {
                    const double c = dot(wo, m), f = test::referenceFresnel(c, eta);
                    if (!(f < 1)) return 0.0;
                    const Vec3d wi = m * (c / eta - safeSqrt(1 - (1 - c * c) / (eta * eta))) - wo * (1 / eta);
                    return wi.z < 0 ? (1 - f) * exactPassing(ggx.lambda(wo), ggx.lambda(wi)) / ggx.G1(wo) : 0.0;
                });
                CHECK(walk.firstTransmitted == doctest::Approx(exact).epsilon(0.02));
            }
}

// One factor for both parts, as [Turquin2019] has it, would reflect 0.06 instead of 0.41 within the roughest glass.
TEST_CASE("rough glass reflects what a walk does, from outside and from within") {
    test::Random random(4);
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
        const double roughness = 0.2 + 0.8 * random.uniformDouble(), alpha = roughness * roughness;
        const double index = 1.25 + 1.35 * random.uniformDouble(), eta = i % 2 ? index : 1 / index;
        const double mu = 0.05 + 0.95 * random.uniformDouble();
        const double expected = test::MicrofacetWalk(mu, alpha, eta)(4000, 7).reflected;
        const auto shares = ggxInterface(static_cast<float>(mu), static_cast<float>(alpha), static_cast<float>(eta));
        const double got =
            test::referenceInterface(mu, alpha, eta).reflected * static_cast<double>(shares.reflection());
        CHECK_MESSAGE(std::abs(got - expected) < 0.025, "mu ", mu, " alpha ", alpha, " eta ", eta, ": ", got,
                      " instead of ", expected);
        worst = std::max(worst, std::abs(got - expected));
    }
    MESSAGE("largest difference ", worst);
    CHECK(test::referenceInterface(1, 1, 1 / 1.5).reflected *
              static_cast<double>(ggxInterface(1, 1, 1 / 1.5f).reflection()) ==
          doctest::Approx(0.41).epsilon(0.03));
}

} // namespace
} // namespace abbe

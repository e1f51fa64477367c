// Samplers against their densities, and sample() against eval().
#include "materials/fresnel.h"
#include "sphere_checks.h"
#include "suite.h"
#include "support/jacobian.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

TEST_CASE("chi-square: samples fall where the density says") {
    Random random(11);
    checkChiSquare(roughSuite(), random, chiSquareSamples(),
                   [](const auto& b, Vec3 wo, bool upper) { return cellsFor(b, wo, upper); });
}

TEST_CASE("the density integrates to one, with the share of rejected samples") {
    const auto cells = [](const auto& b, Vec3 wo, bool upper) { return cellsFor(b, wo, upper); };
    for (const BsdfUnderTest& b : roughSuite())
        for (const Vec3 wo : aroundTheSphere()) {
            const double missing = missingDensity(b, wo, 100000, cells);
            CHECK_MESSAGE(missing < 1e-3, b.name, " wo.z ", wo.z, ": ", missing);
        }
}

// Directions in single precision leave an error of about 1e-7 in the half vector, which a lobe of width α sees as
// 1e-7/α; more near grazing incidence, for weak refraction and,
// because of Fresnel's slope, near the critical angle.
double tolerance(const BsdfUnderTest& b, Vec3 wo) {
    const double contrast = b.eta > 0 ? std::min(1.0, static_cast<double>(b.eta) - 1) : 1;
    return (b.eta > 0 ? 2e-4 : 1e-4) + 4e-7 / (b.alpha * std::abs(wo.z) * contrast);
}

TEST_CASE("sample() returns the weight and the density that eval() gives") {
    Random random(12);
    for (const BsdfUnderTest& b : roughSuite())
        for (const Vec3 wo : aroundTheSphere()) {
            for (const Transport transport : {Transport::radiance, Transport::importance}) {
                const double worst = sampleAgainstEval(*b.bsdf, wo, random, 2000, transport);
                CHECK_MESSAGE(worst < tolerance(b, wo), b.name, " wo.z ", wo.z, ": ", worst);
            }
            bool labels = true;
            meanOfSamples(*b.bsdf, wo, Transport::radiance, 2000, [&](const BsdfSample& s) {
                labels = labels && (s.eta != 1) == s.lobe.has(Lobe::transmission);
                return 0;
            });
            CHECK_MESSAGE(labels, b.name);
        }
}

// The share of numbers for the choice of a lobe that choose as `end`, 0 or nearly 1, does: found by bisection, whatever
// rule chooses.
float shareChosen(const BsdfUnderTest& b, Vec3 wo, Vec2 u, float end, bool reflects) {
    float same = end, other = 1 - end;
    for (int i = 0; i < 24; ++i) {
        const float middle = 0.5f * (same + other);
        const auto s = b.bsdf->sample(wo, middle, u, Transport::radiance);
        (s && s->lobe.has(Lobe::reflection) == reflects ? same : other) = middle;
    }
    return std::abs(same - end);
}

// The map from numbers to directions spreads them as thinly as the density says. A rough interface takes a number for
// the choice between its lobes.
TEST_CASE("Jacobian of the sampling maps") {
    Random random(13);
    for (const BsdfUnderTest& b : roughSuite())
        for (const Vec3 wo : aroundTheSphere())
            for (const float uLobe : {0.f, kOneMinusEpsilon}) {
                if (b.bsdf->lobes().has(Lobe::dispersive) || (b.eta == 0 && uLobe > 0)) continue;
                const auto map = [&](Vec2 u) -> std::optional<Vec3> {
                    const auto s = b.bsdf->sample(wo, uLobe, u, Transport::radiance);
                    if (!s || s->lobe.has(Lobe::reflection) != (uLobe == 0)) return std::nullopt;
                    return s->wi;
                };
                Moments ratio;
                for (int i = 0; i < 400; ++i) {
                    const Vec2 u{0.02f + 0.96f * random.uniform(), 0.02f + 0.96f * random.uniform()};
                    const auto s = b.bsdf->sample(wo, uLobe, u, Transport::radiance);
                    const auto j = jacobian(map, u, b.alpha < 0.05f ? 4e-3f : 1e-3f);
                    if (!s || !j || s->lobe.has(Lobe::reflection) != (uLobe == 0)) continue;
                    const float chosen = b.eta > 0 ? shareChosen(b, wo, u, uLobe, uLobe == 0) : 1;
                    if (chosen > 1e-3f && std::abs(s->wi.z) > 0.05f) ratio.add(*j * s->pdfSolidAngle / chosen);
                }
                if (ratio.count() < 50) continue; // total reflection
                CHECK_MESSAGE(std::abs(ratio.mean() - 1) < 5e-3, b.name, " wo.z ", wo.z, " lobe ", uLobe, ": ",
                              ratio.mean());
            }
}

} // namespace
} // namespace abbe

// Samplers against their densities, and sample() against eval().
#include "materials/fresnel.h"
#include "suite.h"
#include "support/jacobian.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

constexpr double kAngles[] = {0, 30, 65, 85};

// Every pair of side and angle that a scattering function must serve.
std::vector<Vec3> outgoing() {
    std::vector<Vec3> result;
    for (const double a : kAngles) result.push_back(directionAt(a)), result.push_back(mirrored(directionAt(a)));
    return result;
}

TEST_CASE("chi-square: samples fall where the density says") {
    const std::vector<BsdfUnderTest> suite = roughSuite();
    const double level = sidak(1e-3, static_cast<int>(suite.size()) * 16);
    const int samples = chiSquareSamples();
    Random random(11);
    for (const BsdfUnderTest& b : suite)
        for (const Vec3 wo : outgoing())
            for (const bool upper : {true, false}) {
                if (b.eta == 0 && upper != (wo.z > 0)) continue; // opaque: nothing there, energy tests say so
                const auto sample = [&]() -> std::optional<Vec3d> {
                    const float uLobe = random.uniform();
                    const auto s = b.bsdf->sample(wo, uLobe, {random.uniform(), random.uniform()}, Transport::radiance);
                    return s ? std::optional(Vec3d(s->wi)) : std::nullopt;
                };
                const auto pdf = [&](Vec3d wi) {
                    return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::radiance).pdfSolidAngle);
                };
                const ChiSquareResult r = chiSquareDirections(cellsFor(b, wo, upper), sample, pdf, samples);
                CHECK_MESSAGE(r.pValue > level, b.name, " wo.z ", wo.z, upper ? " up" : " down", ": chi2 ", r.statistic,
                              " with ", r.degrees, " degrees");
            }
}

TEST_CASE("the density integrates to one, with the share of rejected samples") {
    for (const BsdfUnderTest& b : roughSuite())
        for (const Vec3 wo : outgoing()) {
            double total =
                1 - meanOfSamples(*b.bsdf, wo, Transport::radiance, 100000, [](const BsdfSample&) { return 1; });
            for (const bool upper : {true, false})
                if (b.eta != 0 || upper == (wo.z > 0))
                    total += cellsFor(b, wo, upper).integral([&](Vec3d wi) {
                        return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::radiance).pdfSolidAngle);
                    });
            CHECK_MESSAGE(std::abs(total - 1) < 1e-3, b.name, " wo.z ", wo.z, ": ", total);
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
        for (const Vec3 wo : outgoing())
            for (const Transport transport : {Transport::radiance, Transport::importance}) {
                double worst = 0;
                bool labels = true;
                for (int i = 0; i < 2000; ++i) {
                    const float uLobe = random.uniform();
                    const auto s = b.bsdf->sample(wo, uLobe, {random.uniform(), random.uniform()}, transport);
                    if (!s) continue;
                    const BsdfEval e = b.bsdf->eval(wo, s->wi, transport);
                    worst = std::max(worst, static_cast<double>(std::abs(e.pdfSolidAngle / s->pdfSolidAngle - 1)));
                    for (int lane = 0; lane < kLanes; ++lane) {
                        const float f = s->weight[lane] * s->pdfSolidAngle, q = s->pdfRatio[lane] * s->pdfSolidAngle;
                        const float scaleF = std::max(f, 1e-6f * s->pdfSolidAngle);
                        const float scaleQ = std::max(q, 1e-6f * s->pdfSolidAngle);
                        worst = std::max(worst, static_cast<double>(std::abs(e.fcos[lane] - f) / scaleF));
                        worst = std::max(
                            worst, static_cast<double>(std::abs(e.pdfRatio[lane] * e.pdfSolidAngle - q) / scaleQ));
                    }
                    const bool reflected = s->wi.z * wo.z > 0;
                    labels = labels && s->lobe.has(Lobe::reflection) == reflected &&
                             s->lobe.has(Lobe::transmission) == !reflected && b.bsdf->lobes().contains(s->lobe) &&
                             (s->eta != 1) == (!reflected);
                }
                CHECK_MESSAGE(worst < tolerance(b, wo), b.name, " wo.z ", wo.z, ": ", worst);
                CHECK_MESSAGE(labels, b.name);
            }
}

// The map from numbers to directions spreads them as thinly as the density says. A rough interface takes a number for
// the choice between its lobes: that of reflection is Fresnel's reflectance of the microfacet.
TEST_CASE("Jacobian of the sampling maps") {
    Random random(13);
    for (const BsdfUnderTest& b : roughSuite())
        for (const Vec3 wo : outgoing())
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
                    const float eta = wo.z > 0 ? b.eta : 1 / b.eta;
                    const Vec3 h = uLobe == 0 ? wo + s->wi : wo + s->wi * eta;
                    float chosen = 1;
                    if (b.eta > 0) {
                        const float reflectance = fresnelDielectric(std::abs(dot(wo, normalize(h))), eta);
                        chosen = uLobe == 0 ? reflectance : 1 - reflectance;
                    }
                    if (chosen > 1e-3f && std::abs(s->wi.z) > 0.05f) ratio.add(*j * s->pdfSolidAngle / chosen);
                }
                if (ratio.count() < 50) continue; // total reflection
                CHECK_MESSAGE(std::abs(ratio.mean() - 1) < 5e-3, b.name, " wo.z ", wo.z, " lobe ", uLobe, ": ",
                              ratio.mean());
            }
}

} // namespace
} // namespace abbe

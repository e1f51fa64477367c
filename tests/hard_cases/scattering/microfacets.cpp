// Microfacets at the ends of their ranges: cases 24 to 27 of docs/hard_cases.md.
#include "hard_cases/hard_case.h"
#include "materials/ggx.h"
#include "statistical/materials/extremes.h"

using namespace abbe;
using namespace abbe::test;

namespace {

constexpr float kCosines[] = {1, 0.5f, 1e-2f, 1e-3f, 1e-5f, 1e-8f, 1e-20f, 1e-37f, 1e-38f, 0};
constexpr float kNumbers[] = {0, 1e-7f, 0.5f, 0.999f, kOneMinusEpsilon};

} // namespace

TEST_CASE("case 24: GGX density at its peak") {
    HardCase c;
    c.doctor();
    double worst = 0;
    for (const float alpha : {1e-4f, 1e-3f})
        for (int i = 0; i < 200; ++i) {
            const float slope = alpha * 3 * static_cast<float>(i) / 200;
            const Vec3 m = normalize(Vec3{slope, 0, 1});
            const double s =
                square(static_cast<double>(m.x) / static_cast<double>(alpha)) + square(static_cast<double>(m.z));
            const double exact = 1 / (kPiD * square(static_cast<double>(alpha)) * s * s);
            const float c2 = m.z * m.z, a2 = alpha * alpha, b = c2 * (a2 - 1) + 1; // [Walter2007] with cos θ
            const double plain = static_cast<double>(a2 / (kPi * b * b));
            worst = std::max(worst, std::abs(plain / exact - 1));
        }
    c.naive("with cos θ", worst);
}

// The stated quarter of a pixel is one of 1/4 of 1.8 mrad: 40° over 400 pixels. A mean would be that of GGX's long
// tail.
TEST_CASE("case 25: α near 0, also in one direction only") {
    HardCase c;
    const BsdfUnderTest mirror = conductor(0.2, 3, 0.0223f), lobe = conductor(0.2, 3, 0.0225f);
    REQUIRE(mirror.bsdf->lobes().has(Lobe::delta));
    REQUIRE(!lobe.bsdf->lobes().has(Lobe::delta));
    const Vec3 wo = directionAt(45);
    const auto exact = mirror.bsdf->sample(wo, 0, {}, Transport::radiance);
    double energy = 0;
    std::vector<double> spread;
    Random random(1);
    for (int i = 0; i < 20000; ++i)
        if (const auto s = lobe.bsdf->sample(wo, 0, {random.uniform(), random.uniform()}, Transport::radiance)) {
            energy += static_cast<double>(s->weight[0]) / 20000;
            // Within the plane of incidence, as a picture of a line would be blurred.
            spread.push_back(std::abs(
                static_cast<double>(dot(s->wi - exact->wi, normalize(Vec3{0, 0, 1} - exact->wi * exact->wi.z)))));
        }
    std::nth_element(spread.begin(), spread.begin() + 10000, spread.end());
    c.measured("energy of the narrowest lobe over the mirror's",
               std::abs(energy / static_cast<double>(exact->weight[0]) - 1), 1e-3);
    c.measured("median deviation, in pixels of 400 over 40°", spread[10000] / (40 * kPiD / 180 / 400), 0.5);
    int bad = 0;
    for (const float x : {0.f, 1e-30f, 1e-6f, 0.5f, 1.f})
        for (const float anisotropy : {0.f, 0.5f, 1.f}) {
            const Ggx ggx = Ggx::fromRoughness(x, anisotropy);
            for (const Vec3 m : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, withCosine(0.5f, 0.3f)})
                bad += !std::isfinite(ggx.D(m)) || !std::isfinite(ggx.visible(m));
        }
    c.measured("densities that are not finite, α of 0 and of one direction 0", bad, 0);
    const volatile float zero = 0;
    c.naive("density along x with αx = 0", static_cast<double>(zero / (zero * zero)));
}

TEST_CASE("case 26: `wi` equal or opposite to `wo`") {
    HardCase c;
    std::vector<Vec3> directions;
    for (const float z : kCosines)
        for (const float side : {1.f, -1.f})
            for (const float azimuth : {0.f, 0.4f, 0.4f + kPi}) directions.push_back(withCosine(side * z, azimuth));
    int bad = 0, pairs = 0;
    for (const BsdfUnderTest& b : extremeSuite())
        for (const Vec3 wo : directions)
            for (std::size_t i = 0; i <= directions.size(); ++i) {
                const BsdfEval e = b.bsdf->eval(wo, i < directions.size() ? directions[i] : -wo, Transport::radiance);
                ++pairs;
                bad += !allFinite(e.fcos) || !allFinite(e.pdfRatio) || !std::isfinite(e.pdfSolidAngle) ||
                       e.pdfSolidAngle < 0 || anyNonZero(Spectrum(min(e.fcos, Spectrum(0.f))));
            }
    CHECK(pairs > 100000);
    c.measured("values that are negative or not finite, over all pairs of 60 directions and 43 materials", bad, 0);
    const Vec3 wo = withCosine(0.5f, 0.4f), sum = wo + -wo;
    c.naive("half vector of opposite directions", static_cast<double>((sum * (1 / length(sum))).z));
}

TEST_CASE("case 27: grazing directions") {
    HardCase c;
    int bad = 0;
    float heaviest = 0;
    for (const BsdfUnderTest& b : extremeSuite())
        for (const float cosine : kCosines)
            for (const float side : {1.f, -1.f})
                for (const float lobe : kNumbers)
                    for (const float u : kNumbers)
                        for (const float v : kNumbers) {
                            const Vec3 wo = withCosine(side * cosine, 0.4f);
                            const auto s = b.bsdf->sample(wo, lobe, {u, v}, Transport::importance);
                            if (!s) continue;
                            bad += !allFinite(s->weight) || !allFinite(s->pdfRatio) || !isFinite(s->wi) ||
                                   !(s->pdfSolidAngle > 0) || !std::isfinite(s->pdfSolidAngle);
                            if (b.bsdf->lobes().has(Lobe::dispersive)) continue; // only ratios are bounded
                            // Compensation makes up for what single scattering lost.
                            float scale = 1;
                            if (b.alpha > 0 && b.eta == 0) scale = 1 / ggxAlbedo(cosine, std::min(1.f, b.alpha));
                            if (b.alpha > 0 && b.eta > 0) {
                                const auto shares = ggxInterface(cosine, b.alpha, wo.z > 0 ? b.eta : 1 / b.eta);
                                scale = std::max(shares.reflection(), shares.transmission());
                            }
                            heaviest = std::max(heaviest, maxLane(s->weight) / std::max(1.f, scale));
                        }
    c.measured("samples that are not finite, cosines from 1 to 0", bad, 0);
    c.measured("largest weight", static_cast<double>(heaviest), 1.5);
    // The value with its cosine in the denominator, over the density with the same.
    const float cosine = 1e-38f, d = 1, g = 2e-38f;
    const volatile float value = d * g / (4 * cosine * cosine), density = d / (4 * cosine);
    c.naive("f cos θ/p at a cosine of 1e-38", static_cast<double>(value * cosine / density));
}

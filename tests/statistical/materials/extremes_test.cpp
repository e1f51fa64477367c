// Directions and numbers at the edge of their ranges (docs/hard_cases.md, cases 25 to 27).
#include "extremes.h"
#include "materials/ggx.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

constexpr float kCosines[] = {1, 0.5f, 1e-2f, 1e-3f, 1e-5f, 1e-8f, 1e-12f, 1e-20f, 1e-30f, 1e-37f, 1e-38f, 0};
constexpr float kNumbers[] = {0, 1e-7f, 0.25f, 0.5f, 0.999f, kOneMinusEpsilon};

bool finite(const BsdfEval& e) {
    return allFinite(e.fcos) && allFinite(e.pdfRatio) && std::isfinite(e.pdfSolidAngle) && e.pdfSolidAngle >= 0 &&
           !anyNonZero(Spectrum(min(e.fcos, Spectrum(0.f))));
}

TEST_CASE("samples at every cosine and number are finite, and no weight is large") {
    for (const BsdfUnderTest& b : extremeSuite()) {
        bool good = true;
        float heaviest = 0;
        for (const float c : kCosines)
            for (const float side : {1.f, -1.f})
                for (const float lobe : kNumbers)
                    for (const float u : kNumbers)
                        for (const float v : kNumbers) {
                            const Vec3 wo = withCosine(side * c, 0.4f);
                            const auto s = b.bsdf->sample(wo, lobe, {u, v}, Transport::importance);
                            if (!s) continue;
                            good = good && allFinite(s->weight) && allFinite(s->pdfRatio) && isFinite(s->wi) &&
                                   s->pdfSolidAngle > 0 && std::isfinite(s->pdfSolidAngle) && s->eta > 0 &&
                                   std::abs(length(s->wi) - 1) < 1e-5f;
                            if (b.bsdf->lobes().has(Lobe::dispersive)) continue; // only ratios of densities are bounded
                            // Compensation makes up for what single scattering lost.
                            float scale = 1;
                            if (b.alpha > 0 && b.eta == 0) scale = 1 / ggxAlbedo(c, std::min(1.f, b.alpha));
                            if (b.alpha > 0 && b.eta > 0) {
                                const auto shares = ggxInterface(c, b.alpha, wo.z > 0 ? b.eta : 1 / b.eta);
                                scale = std::max(shares.reflection(), shares.transmission());
                            }
                            heaviest = std::max(heaviest, maxLane(s->weight) / std::max(1.f, scale));
                        }
        CHECK_MESSAGE(good, b.name);
        CHECK_MESSAGE(heaviest <= 1.5f, b.name, ": ", heaviest);
    }
}

TEST_CASE("eval is finite for all pairs of directions, equal and opposite ones among them") {
    std::vector<Vec3> directions;
    for (const float c : kCosines)
        for (const float side : {1.f, -1.f})
            for (const float azimuth : {0.f, 0.4f, 2.f, 0.4f + kPi})
                directions.push_back(withCosine(side * c, azimuth));
    for (const BsdfUnderTest& b : extremeSuite()) {
        bool good = true;
        for (const Vec3 wo : directions) {
            for (const Vec3 wi : directions) good = good && finite(b.bsdf->eval(wo, wi, Transport::radiance));
            good = good && finite(b.bsdf->eval(wo, -wo, Transport::radiance));
        }
        CHECK_MESSAGE(good, b.name);
    }
}

// Case 25: where a lobe turns into a mirror, nothing jumps.
TEST_CASE("the narrowest lobe is a mirror for any picture") {
    const BsdfUnderTest mirror = conductor(0.2, 3, 0.0223f), lobe = conductor(0.2, 3, 0.0225f);
    CHECK(mirror.bsdf->lobes().has(Lobe::delta));
    CHECK(!lobe.bsdf->lobes().has(Lobe::delta));
    const Vec3 wo = directionAt(45);
    const auto exact = mirror.bsdf->sample(wo, 0, {}, Transport::radiance);
    double energy = 0, spread = 0;
    const EvenPoints points(20000);
    for (int i = 0; i < points.count; ++i)
        if (const auto s = lobe.bsdf->sample(wo, 0, points(i).u, Transport::radiance)) {
            energy += s->weight[0] / points.count;
            spread += length(s->wi - exact->wi) / points.count;
        }
    CHECK(energy == doctest::Approx(exact->weight[0]).epsilon(1e-3));
    CHECK(spread < 3e-3);
}

} // namespace
} // namespace abbe

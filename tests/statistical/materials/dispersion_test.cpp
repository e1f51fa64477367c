// Spectral multiple importance sampling of dispersive interfaces [Wilkie2014]: all eight wavelengths carried by paths
// of any hero must give what each wavelength gives alone.
#include "hero_checks.h"
#include "suite.h"
#include "support/nightly.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

constexpr int kSamples = 40000;

TEST_CASE("each wavelength gets what it gets alone") {
    const CauchyCurve flint(1.55, 0.03); // about three times the dispersion of SF11
    const Wavelengths w = Wavelengths::sample(0.7f);
    for (const float roughness : {0.f, 0.03f, 0.15f, 0.3f, 0.6f, 1.f}) {
        if (!nightly() && roughness != 0 && roughness != 0.15f && roughness != 1) continue;
        for (const Vec3 wo : {directionAt(0), directionAt(50), directionAt(80), mirrored(directionAt(20)),
                              mirrored(directionAt(37)), mirrored(directionAt(70))}) {
            const auto together = throughAllHeroes(
                [&](const Wavelengths& lanes) { return dispersiveGlass(flint, roughness, lanes); }, w, wo, kSamples);
            for (int lane = 0; lane < kLanes; ++lane) {
                const BsdfUnderTest alone = dispersiveGlass(flint, roughness, Wavelengths::single(w.nm[lane]));
                const double expected = meanOfSamples(*alone.bsdf, wo, Transport::importance, kSamples,
                                                      [](const BsdfSample& s) { return s.weight[0] * sky(s.wi); });
                const double got = together[static_cast<std::size_t>(lane)];
                CHECK_MESSAGE(std::abs(got / expected - 1) < 5e-3, "roughness ", roughness, " wo.z ", wo.z, " lane ",
                              lane, ": ", got, " instead of ", expected);
            }
        }
    }
}

TEST_CASE("densities are the same whichever lane is the hero") {
    const CauchyCurve flint(1.55, 0.03);
    const Wavelengths w = Wavelengths::sample(0.2f);
    Random random(31);
    for (const float roughness : {0.05f, 0.3f, 1.f}) {
        std::vector<BsdfUnderTest> heroes;
        for (int hero = 0; hero < kLanes; ++hero) heroes.push_back(dispersiveGlass(flint, roughness, rotated(w, hero)));
        for (int i = 0; i < 2000; ++i) {
            const Vec3 wo = squareToSphere({random.uniform(), random.uniform()});
            const auto s = heroes[static_cast<std::size_t>(i % kLanes)].bsdf->sample(
                wo, random.uniform(), {random.uniform(), random.uniform()}, Transport::radiance);
            if (!s) continue;
            const BsdfEval first = heroes[0].bsdf->eval(wo, s->wi, Transport::radiance);
            const float largest = maxLane(first.pdfRatio) * first.pdfSolidAngle;
            for (int hero = 1; hero < kLanes; ++hero) {
                const BsdfEval e = heroes[static_cast<std::size_t>(hero)].bsdf->eval(wo, s->wi, Transport::radiance);
                for (int lane = 0; lane < kLanes; ++lane) {
                    const int there = (hero + lane) % kLanes;
                    const float a = first.pdfRatio[there] * first.pdfSolidAngle, b = e.pdfRatio[lane] * e.pdfSolidAngle;
                    CHECK(std::abs(a - b) <= 1e-4f * std::max({a, b, 0.01f * largest}));
                    CHECK(first.fcos[there] == doctest::Approx(e.fcos[lane]).epsilon(1e-4));
                }
            }
        }
    }
}

TEST_CASE("reflection keeps all wavelengths, polished refraction only the hero's") {
    const CauchyCurve flint(1.55, 0.03);
    const BsdfUnderTest b = dispersiveGlass(flint, 0, Wavelengths::sample(0.1f));
    CHECK(b.bsdf->lobes().has(Lobe::dispersive));
    const auto reflected = b.bsdf->sample(directionAt(40), 0, {}, Transport::radiance);
    REQUIRE(reflected);
    CHECK(!reflected->lobe.has(Lobe::dispersive));
    CHECK(mean(reflected->weight) == doctest::Approx(1));
    CHECK(reflected->weight[0] != reflected->weight[1]);
    const auto refracted = b.bsdf->sample(directionAt(40), 0.5f, {}, Transport::radiance);
    REQUIRE(refracted);
    CHECK(refracted->lobe.has(Lobe::dispersive));
    CHECK(allFinite(refracted->weight));
}

} // namespace
} // namespace abbe

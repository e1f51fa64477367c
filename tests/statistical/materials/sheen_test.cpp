// The sheen lobe against the layer of fibres that it stands for, and the cloth that it lies on.
#include "materials/sheen.h"
#include "sphere_checks.h"
#include "support/sheen_layer.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <random>

namespace abbe {
namespace {

using namespace test;

constexpr float kRoughnesses[] = {0.f, 0.1f, 0.33f, 0.7f, 1.f};

TEST_CASE("sheen: share and mean direction of the light that the layer of fibres throws back") {
    std::mt19937_64 bits(5);
    const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
    double worstShare = 0, worstMean = 0;
    for (const double roughness : {0.08, 0.25, 0.5, 0.9})
        for (const double cosine : {0.02, 0.15, 0.4, 0.7, 1.0}) {
            const SheenLayer layer(roughness);
            const SheenLobe lobe(static_cast<float>(roughness));
            const Vec3d wo{std::sqrt(1 - cosine * cosine), 0, cosine};
            constexpr int photons = 100000;
            int back = 0;
            Vec3d sum{}, fitted{};
            for (int i = 0; i < photons; ++i)
                if (const auto w = layer.reflect(wo, uniform)) ++back, sum = sum + *w;
            const EvenPoints points(4096);
            for (int i = 0; i < points.count; ++i)
                fitted = fitted + Vec3d(lobe.sample(Vec3(wo), points(i).u)) * (1.0 / points.count);
            const double share = static_cast<double>(back) / photons;
            worstShare = std::max(worstShare, std::abs(share - lobe.albedo(static_cast<float>(cosine))));
            worstMean = std::max(worstMean, length(sum * (1.0 / back) - fitted));
        }
    MESSAGE("albedo off by at most ", worstShare, ", mean direction by ", worstMean);
    CHECK(worstShare < 0.012); // simulation: 4 standard deviations are 0.006; the rest is interpolation
    CHECK(worstMean < 0.12);   // one lobe of Lambert's kind for a sum of many bounces
}

TEST_CASE("sheen: the lobe integrates to its albedo, over cosine and roughness") {
    for (const float roughness : kRoughnesses)
        for (const double angle : {0.0, 30.0, 65.0, 85.0, 89.9}) {
            const SheenLobe lobe(roughness);
            const Vec3 wo = directionAt(angle, 2.1);
            const double e = HemisphereCells(true, Vec3d(-wo.x, -wo.y, wo.z), 0.3, 48, 48).integral([&](Vec3d wi) {
                return static_cast<double>(lobe.eval(wo, Vec3(wi)).fcos);
            });
            CHECK(e == doctest::Approx(lobe.albedo(wo.z)).epsilon(1e-3));
            CHECK(lobe.albedo(wo.z) < 1);
        }
}

BsdfUnderTest cloth(float roughness, const Curve* color, const Curve* base) {
    SheenParams params;
    params.color.curve = color;
    params.baseColor.curve = base;
    params.roughness.value = roughness;
    return {fmt::format("sheen roughness {}", roughness), makeSheen(params), 1};
}

TEST_CASE("sheen: samples fall where the density says, and weigh what eval() gives") {
    Random random(71);
    const double level = sidak(1e-3, 5 * 8);
    for (const float roughness : kRoughnesses) {
        const BsdfUnderTest b = cloth(roughness, nullptr, nullptr);
        for (const Vec3 wo : aroundTheSphere()) {
            const double p = chiSquareOfSphere(*b.bsdf, wo, {-wo.x, -wo.y, wo.z}, 0.3, random, chiSquareSamples());
            CHECK_MESSAGE(p > level, b.name, " wo.z ", wo.z, ": p ", p);
            const double worst = sampleAgainstEval(*b.bsdf, wo, random);
            CHECK_MESSAGE(worst < 1e-4, b.name, " wo.z ", wo.z, ": ", worst);
        }
        CHECK_MESSAGE(heaviestAtExtremes(*b.bsdf) <= 1.001f, b.name);
    }
}

TEST_CASE("sheen: white fuzz on white ground is a white furnace; black ground shows the fuzz alone") {
    const ConstantCurve one(1), none(0);
    for (const float roughness : kRoughnesses)
        for (const Vec3 wo : aroundTheSphere()) {
            const BsdfUnderTest white = cloth(roughness, &one, &one), black = cloth(roughness, &one, &none);
            CHECK(std::abs(albedoBySampling(*white.bsdf, wo) - 1) < 2e-3);
            CHECK(albedoBySampling(*black.bsdf, wo) ==
                  doctest::Approx(SheenLobe(roughness).albedo(std::abs(wo.z))).epsilon(2e-3));
        }
    CHECK(heaviestAtExtremes(*cloth(0.3f, &none, &none).bsdf) == 0);
}

} // namespace
} // namespace abbe

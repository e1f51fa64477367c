// Mixtures of a surface's own directions with even ones: samples follow the density of the mixture, and what they add
// up to is the surface's own.
#include "openpbr_suite.h"
#include "path_tracing/directed_bsdf.h"
#include "sphere_checks.h"
#include "suite.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

constexpr float kShares[] = {0.5f, 0.1f, 1};

// The same surface, its directions mixed.
BsdfUnderTest mixed(BsdfUnderTest b, float share) {
    b.name += fmt::format(", {} of the directions even", share);
    b.bsdf = b.arena->make<DefensiveBsdf>(*b.bsdf, b.eta > 0 ? b.eta : 1, share);
    return b;
}

std::vector<BsdfUnderTest> reflectors() {
    std::vector<BsdfUnderTest> all;
    for (const float share : kShares) {
        all.push_back(mixed({"diffuse", makeDiffuse({}), 1.f}, share));
        for (const float r : {0.3f, 0.6f}) all.push_back(mixed(conductor(0.2, 3, r), share));
    }
    return all;
}

} // namespace

// Where a surface scatters nothing, even directions are dropped: a test of the density needs surfaces that scatter
// everywhere.
TEST_CASE("defensive mixtures: samples fall where the density says") {
    Random random(21);
    checkChiSquare(reflectors(), random, chiSquareSamples(),
                   [](const auto& b, Vec3 wo, bool upper) { return cellsFor(b, wo, upper); });
}

TEST_CASE("defensive mixtures: sample() returns the weight and the density that eval() gives") {
    Random random(22);
    auto all = reflectors();
    for (const float share : kShares)
        for (const float r : {0.3f, 1.f}) all.push_back(mixed(dielectric(1.5, r), share));
    for (const BsdfUnderTest& b : all)
        for (const Vec3 wo : aroundTheSphere()) {
            const double worst = sampleAgainstEval(*b.bsdf, wo, random, 2000, Transport::radiance);
            CHECK_MESSAGE(worst < 1e-3, b.name, " wo.z ", wo.z, ": ", worst);
        }
}

TEST_CASE("defensive mixtures: weights have the mean that the surface's own have, with delta lobes, too") {
    OpenPbrParams varnish = whiteOpenPbr(), glass = whiteOpenPbr();
    varnish.specularRoughness = number(0);
    glass.specularRoughness = number(0);
    glass.transmissionWeight = number(0.5);
    const auto surfaces = [&] {
        std::vector<BsdfUnderTest> all;
        all.emplace_back("diffuse", makeDiffuse({}), 1.f);
        all.push_back(conductor(0.2, 3, 0.3f));
        all.push_back(dielectric(1.5, 0.3f));
        all.push_back(dielectric(1.5, 0)); // nothing to mix
        all.push_back(openPbr(varnish, "matte under smooth varnish"));
        all.push_back(openPbr(glass, "half matte, half clear"));
        return all;
    };
    const auto weight = [](const BsdfSample& s) { return static_cast<double>(mean(s.weight)); };
    constexpr int kCount = 1 << 18;
    const auto own = surfaces();
    for (const float share : kShares) {
        auto bare = surfaces();
        for (std::size_t i = 0; i < bare.size(); ++i) {
            const BsdfUnderTest b = mixed(std::move(bare[i]), share);
            for (const Vec3 wo : {directionAt(20), directionAt(70)}) {
                const double expected = meanOfSamples(*own[i].bsdf, wo, Transport::radiance, kCount, weight);
                const double found = meanOfSamples(*b.bsdf, wo, Transport::radiance, kCount, weight);
                CHECK_MESSAGE(std::abs(found - expected) < 2e-3, b.name, " wo.z ", wo.z, ": ", found, " ", expected);
            }
        }
    }
}

// Products of them are what a path carries.
TEST_CASE("defensive mixtures: weights are at most 1/(1 - share) of the surface's own") {
    for (const float share : {0.5f, 0.1f})
        for (const BsdfUnderTest& b : {mixed(conductor(0.2, 3, 0.1f), share), mixed(dielectric(1.5, 0.1f), share)}) {
            double most = 0;
            const Bsdf& bsdf = *b.bsdf;
            const Vec3 wo = directionAt(40);
            meanOfSamples(bsdf, wo, Transport::radiance, 1 << 14, [&](const BsdfSample& s) {
                const float own = static_cast<const DefensiveBsdf&>(bsdf).ownDensity(wo, s.wi);
                if (own > 0) most = std::max(most, static_cast<double>(own / s.pdfSolidAngle));
                return 0;
            });
            CHECK_MESSAGE(most < 1.0001 / (1 - share), b.name, ": ", most);
            CHECK(most > 0.9 / (1 - share));
        }
}

} // namespace abbe

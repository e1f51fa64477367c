// The OpenPBR surface's samples against its densities, and both against its values.
#include "hero_checks.h"
#include "openpbr_suite.h"
#include "sphere_checks.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

struct Structure {
    const char* name;
    void (*set)(OpenPbrParams&);
    bool dispersive = false;
};

// Every lobe alone and all of them together; roughnesses that a χ² test can resolve.
const Structure kStructures[] = {
    {"plastic", [](OpenPbrParams&) {}},
    {"rough plastic", [](OpenPbrParams& p) { p.specularRoughness = number(0.8), p.baseDiffuseRoughness = number(1); }},
    {"filmed metal", [](OpenPbrParams& p) { p.baseMetalness = number(1), p.thinFilmWeight = number(1); }},
    {"brushed coated metal",
     [](OpenPbrParams& p) {
         p.baseMetalness = number(1), p.coatWeight = number(0.7), p.coatRoughness = number(0.2);
         p.specularRoughnessAnisotropy = number(0.7), p.coatRoughnessAnisotropy = number(0.4);
     }},
    {"car paint",
     [](OpenPbrParams& p) {
         p.baseMetalness = number(0.5), p.coatWeight = number(1), p.coatRoughness = number(0.25);
         p.coatColor = color(flat(0.2)), p.thinFilmWeight = number(0.5);
     }},
    {"frosted glass", [](OpenPbrParams& p) { p.transmissionWeight = number(1), p.specularRoughness = number(0.5); }},
    {"prism",
     [](OpenPbrParams& p) {
         p.transmissionWeight = number(1), p.transmissionDispersionScale = 1, p.specularRoughness = number(0.4);
     },
     true},
    {"stretched glass",
     [](OpenPbrParams& p) {
         p.transmissionWeight = number(1), p.specularRoughness = number(0.5);
         p.specularRoughnessAnisotropy = number(0.6);
     }},
    {"velvet", [](OpenPbrParams& p) { p.fuzzWeight = number(1), p.fuzzRoughness = number(0.3); }},
    {"leaf",
     [](OpenPbrParams& p) {
         p.geometryThinWalled = true, p.subsurfaceWeight = number(0.7), p.subsurfaceScatterAnisotropy = 0.3;
         p.transmissionWeight = number(0.5), p.transmissionColor = color(flat(0.2));
         p.specularRoughness = number(0.6);
     }},
    {"skin",
     [](OpenPbrParams& p) {
         p.subsurfaceWeight = number(0.7), p.coatWeight = number(0.5), p.coatRoughness = number(0.3);
         p.coatColor = color(flat(0.2)), p.specularRoughness = number(0.4), p.fuzzWeight = number(0.3);
         p.baseMetalness = number(0.1);
     }},
    {"everything",
     [](OpenPbrParams& p) {
         p.baseMetalness = number(0.3), p.transmissionWeight = number(0.5), p.coatWeight = number(0.6);
         p.coatRoughness = number(0.3), p.fuzzWeight = number(0.4), p.thinFilmWeight = number(0.5);
         p.specularRoughness = number(0.4), p.coatColor = color(flat(0.2)), p.transmissionDispersionScale = 0.5;
     },
     true},
};

std::vector<BsdfUnderTest> openpbrSuite() {
    std::vector<BsdfUnderTest> result;
    for (const Structure& s : kStructures) {
        OpenPbrParams p;
        s.set(p);
        result.push_back(openPbr(p, s.name, s.dispersive ? Wavelengths::sample(0.3f) : Wavelengths::single(550)));
    }
    return result;
}

HemisphereCells cells(const BsdfUnderTest& b, Vec3 wo, bool upper) {
    if (b.eta > 0 || upper == (wo.z > 0)) return cellsFor(b, wo, upper);
    return {upper, Vec3d(-wo), 0.3 * static_cast<double>(b.alpha)}; // through a sheet: straight on
}

TEST_CASE("OpenPBR: chi-square") {
    Random random(11);
    checkChiSquare(openpbrSuite(), random, chiSquareSamples() / 2, cells);
}

TEST_CASE("OpenPBR: the density integrates to one, with the share of rejected samples") {
    for (const BsdfUnderTest& b : openpbrSuite())
        for (const Vec3 wo : aroundTheSphere()) {
            const double missing = missingDensity(b, wo, 60000, cells);
            CHECK_MESSAGE(missing < 3e-3, b.name, " wo.z ", wo.z, ": ", missing);
        }
}

// The value is what the samples average to: ∫ f cos, by quadrature and by sampling.
TEST_CASE("OpenPBR: sample() and eval() tell of the same light") {
    for (const BsdfUnderTest& b : openpbrSuite())
        for (const Vec3 wo : aroundTheSphere()) {
            double integral = 0;
            for (const bool upper : {true, false})
                if (reaches(b, wo, upper))
                    integral += cells(b, wo, upper).integral([&](Vec3d wi) {
                        return static_cast<double>(b.bsdf->eval(wo, Vec3(wi), Transport::importance).fcos[0]);
                    });
            const double sampled = meanOfSamples(*b.bsdf, wo, Transport::importance, 60000,
                                                 [](const BsdfSample& s) { return s.weight[0]; });
            CHECK_MESSAGE(std::abs(integral - sampled) < 4e-3, b.name, " wo.z ", wo.z, ": ", integral, " and ",
                          sampled);
        }
}

TEST_CASE("OpenPBR: samples carry eval's weight and density, and lobes() names them") {
    Random random(12);
    for (const BsdfUnderTest& b : openpbrSuite())
        for (const Vec3 wo : aroundTheSphere()) {
            double worst = 0;
            bool labels = true;
            for (int i = 0; i < 1000; ++i) {
                const float uLobe = random.uniform();
                const auto s = b.bsdf->sample(wo, uLobe, {random.uniform(), random.uniform()}, Transport::radiance);
                if (!s) continue;
                labels = labels && s->lobe.has(Lobe::transmission) == (s->wi.z * wo.z < 0) &&
                         b.bsdf->lobes().contains(s->lobe);
                if (s->lobe.has(Lobe::delta)) continue;
                const BsdfEval e = b.bsdf->eval(wo, s->wi, Transport::radiance);
                worst = std::max(worst, static_cast<double>(std::abs(e.pdfSolidAngle / s->pdfSolidAngle - 1)));
                for (int lane = 0; lane < kLanes; ++lane) {
                    const float f = s->weight[lane] * s->pdfSolidAngle;
                    worst = std::max(
                        worst, static_cast<double>(std::abs(e.fcos[lane] - f) / std::max(f, 1e-4f * s->pdfSolidAngle)));
                }
            }
            CHECK_MESSAGE(worst < 1e-4, b.name, " wo.z ", wo.z, ": ", worst);
            CHECK_MESSAGE(labels, b.name);
        }
}

TEST_CASE("OpenPBR: each wavelength gets what it gets alone") {
    const Wavelengths w = Wavelengths::sample(0.7f);
    constexpr int samples = 20000;
    for (const Structure& structure : kStructures) {
        if (!structure.dispersive) continue;
        for (const double roughness : {0.0, 0.4})
            for (const Vec3 wo : {directionAt(50), mirrored(directionAt(37)), mirrored(directionAt(70))}) {
                OpenPbrParams p;
                structure.set(p);
                p.specularRoughness = number(roughness);
                const auto make = [&](const Wavelengths& lanes) { return openPbr(p, structure.name, lanes); };
                const auto together = throughAllHeroes(make, w, wo, samples);
                for (int lane = 0; lane < kLanes; ++lane) {
                    const BsdfUnderTest alone = make(Wavelengths::single(w.nm[lane]));
                    const double expected = meanOfSamples(*alone.bsdf, wo, Transport::importance, samples,
                                                          [](const BsdfSample& s) { return s.weight[0] * sky(s.wi); });
                    const double got = together[static_cast<std::size_t>(lane)];
                    CHECK_MESSAGE(std::abs(got / expected - 1) < 8e-3, structure.name, " roughness ", roughness,
                                  " wo.z ", wo.z, " lane ", lane, ": ", got, " instead of ", expected);
                }
            }
    }
}

// Cases 25 to 28, 39 to 41: any unit vectors, any numbers; smooth and rough, alone and mixed.
TEST_CASE("OpenPBR: finite at every cosine and number, whatever the surface") {
    RandomOpenPbr cube(9);
    for (int i = 0; i < 60; ++i) {
        const OpenPbrParams p = cube(i % 2, true, i % 10 == 0);
        const BsdfUnderTest b = openPbr(p, describe(p), i % 3 ? Wavelengths::sample(0.4f) : Wavelengths::single(500));
        CHECK_MESSAGE(heaviestAtExtremes(*b.bsdf) < kInfinity, b.name);
    }
}

} // namespace
} // namespace abbe

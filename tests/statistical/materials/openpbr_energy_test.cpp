// Energy of the OpenPBR surface over its parameter cube.
#include "openpbr_suite.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

// Mean weight per lane, in equilibrium: radiance that refraction compressed counts η² times.
double albedo(const Bsdf& bsdf, Vec3 wo, int samples, int lane = 0) {
    return meanOfSamples(bsdf, wo, Transport::radiance, samples,
                         [lane](const BsdfSample& s) { return s.weight[lane] * s.eta * s.eta; });
}

struct Furnace {
    double worst = 0, worstWithin = 0, sum = 0;
    int count = 0;
    std::string where, whereWithin;

    // `turned`: seen across what it is stretched along; `outside`: index of what lies there, null: air.
    void add(const OpenPbrParams& p, int samples, bool turned = false, const Curve* outside = nullptr) {
        BsdfUnderTest b = openPbr(p, describe(p));
        SurfaceHit hit;
        hit.outside = outside;
        if (outside) b.bsdf = b.material->bsdf(hit, Wavelengths::single(550), *b.arena);
        for (const double degrees : {5.0, 40.0, 65.0, 80.0, 87.0}) {
            const Vec3 w = directionAt(degrees), wo = turned ? Vec3{w.y, w.x, w.z} : w;
            note(errorOf(*b.bsdf, wo, samples), b.name, degrees, worst, where);
            if (b.eta > 0) note(errorOf(*b.bsdf, mirrored(wo), samples), b.name, degrees, worstWithin, whereWithin);
        }
    }
    void report() const {
        MESSAGE("mean error ", sum / count, ", largest ", worst, ": ", where, "; within ", worstWithin, ": ",
                whereWithin);
    }

  private:
    // What is doubtful is looked at again: of a few thousand samples the sum itself is not exact.
    static double errorOf(const Bsdf& bsdf, Vec3 wo, int samples) {
        const double error = std::abs(albedo(bsdf, wo, samples) - 1);
        return error < 0.003 ? error : std::abs(albedo(bsdf, wo, 20 * samples) - 1);
    }
    void note(double error, const std::string& name, double degrees, double& largest, std::string& place) {
        sum += error, ++count;
        if (error > largest) largest = error, place = fmt::format("{} at {}", name, degrees);
    }
};

TEST_CASE("white furnace over the cube: opaque surfaces") {
    RandomOpenPbr cube(1);
    Furnace furnace;
    for (int i = 0; i < 150; ++i) furnace.add(cube(true, true, false), 4000);
    furnace.report();
    CHECK(furnace.worst < 0.005);
    CHECK(furnace.sum / furnace.count < 0.001);
}

TEST_CASE("white furnace over the cube: translucent surfaces, from both sides") {
    RandomOpenPbr cube(2);
    Furnace furnace;
    for (int i = 0; i < 150; ++i) furnace.add(cube(false, true, false), 4000);
    furnace.report();
    CHECK(furnace.worst < 0.005);
    CHECK(furnace.worstWithin < 0.005);
    CHECK(furnace.sum / furnace.count < 0.001);
}

// Bases, coats and films thinner than what is around them, which reflect totally, and weights above 1.
TEST_CASE("white furnace over the cube: relative indices from 0.3 to 10") {
    RandomOpenPbr cube(6);
    std::deque<ConstantCurve> curves;
    Furnace furnace;
    for (int i = 0; i < 150; ++i) {
        OpenPbrParams p = cube(i % 4 == 0, true, false);
        const auto between = [&](double low, double high) { return low + (high - low) * cube.random.uniformDouble(); };
        p.specularIor = &curves.emplace_back(i % 5 == 0 ? between(2, 10) : between(0.3, 1.5));
        if (!(p.baseMetalness.value > 0)) p.specularWeight = number(i % 2 ? between(0, 3) : between(0, 1));
        p.coatIor = number(i % 3 == 0 ? between(0.6, 1) : between(1, 2.2));
        p.thinFilmIor = number(between(0.9, 2.3));
        furnace.add(p, 4000, false, i % 6 == 0 ? &flat(1.33) : nullptr);
    }
    furnace.report();
    CHECK(furnace.worst < 0.005);
    CHECK(furnace.worstWithin < 0.005);
    CHECK(furnace.sum / furnace.count < 0.001);
}

// It lost up to half: the base under the coat and that beside it had critical angles of their own.
TEST_CASE("white furnace: thin glass under a dense coat, with a modulated index") {
    static const ConstantCurve thin(0.73), thinner(0.9);
    Furnace furnace;
    for (const double roughness : {0.0, 0.3, 0.8})
        for (const double coat : {1.0, 0.5}) {
            OpenPbrParams p = whiteOpenPbr();
            p.transmissionWeight = number(1), p.specularRoughness = number(roughness);
            p.specularIor = &thin, p.specularWeight = number(0.46);
            p.coatWeight = number(coat), p.coatIor = number(1.72);
            furnace.add(p, 8000);
        }
    OpenPbrParams filmed = whiteOpenPbr();
    filmed.transmissionWeight = number(1), filmed.specularRoughness = number(0.96), filmed.specularIor = &thinner;
    filmed.thinFilmWeight = number(0.4), filmed.thinFilmIor = number(1.5);
    furnace.add(filmed, 8000);
    furnace.report();
    CHECK(furnace.worst < 0.005);
    CHECK(furnace.worstWithin < 0.005);
}

// Where next to nothing is reflected until the critical angle, or the grazing one, is all but reached. Clear glass
// within 0.1 % of its surroundings lies between the first indices of the tables.
TEST_CASE("white furnace: indices that nearly match, of the surface, what is around it and the coat") {
    std::deque<ConstantCurve> curves;
    Furnace bare, coated, matched;
    for (const double step : {-0.05, -0.01, -0.001, 0.0, 1e-4, 0.001, 0.003, 0.01, 0.03, 0.1})
        for (const double roughness : {0.0, 0.05, 0.15, 0.4, 1.0})
            for (const bool opaque : {false, true})
                for (const bool inWater : {false, true}) {
                    OpenPbrParams p = whiteOpenPbr();
                    p.transmissionWeight = number(!opaque), p.specularRoughness = number(roughness);
                    p.specularIor = &curves.emplace_back((inWater ? 1.33 : 1) * (1 + step));
                    (opaque || std::abs(step) > 0.002 ? bare : matched)
                        .add(p, 4000, false, inWater ? &flat(1.33) : nullptr);
                    p.coatWeight = number(1), p.coatRoughness = number(roughness);
                    p.specularIor = &curves.emplace_back(1.5 * (1 + step)), p.coatIor = number(1.5);
                    coated.add(p, 4000, false, inWater ? &flat(1.33) : nullptr);
                }
    for (const Furnace* furnace : {&bare, &coated, &matched}) {
        furnace->report();
        CHECK(furnace->worst < (furnace == &matched ? 0.016 : 0.005));
        CHECK(furnace->worstWithin < (furnace == &matched ? 0.016 : 0.005));
    }
}

TEST_CASE("white furnace over the cube: stretched highlights") {
    RandomOpenPbr cube(3);
    Furnace furnace;
    for (int i = 0; i < 20; ++i) furnace.add(cube(true, false, true), 4000);
    furnace.report();
    CHECK(furnace.worst < 0.005);
}

// Chosen corners: where other microfacets stop what is reflected far more often than what goes through, or less.
TEST_CASE("white furnace: film and coat on rough glass, from both sides") {
    std::deque<ConstantCurve> curves;
    Furnace furnace;
    for (const double ior : {1.1, 1.5, 2.4})
        for (const double roughness : {0.2, 0.5, 0.85, 1.0})
            for (const double cover : {1.0, 2.0, 3.0}) {
                OpenPbrParams p = whiteOpenPbr();
                p.transmissionWeight = number(1), p.specularRoughness = number(roughness);
                p.specularIor = &curves.emplace_back(ior);
                p.coatWeight = number(cover != 2), p.coatIor = number(cover == 1 ? 2 : 1.5);
                p.thinFilmWeight = number(cover != 1), p.thinFilmIor = number(1 + 0.35 * cover);
                p.thinFilmThickness = cover * 150e-9;
                furnace.add(p, 8000);
            }
    furnace.report();
    CHECK(furnace.worst < 0.005);
    CHECK(furnace.worstWithin < 0.005);
    CHECK(furnace.sum / furnace.count < 0.0006);
}

TEST_CASE("white furnace: stretched rough glass, from both sides, in air and in water") {
    RandomOpenPbr cube(5);
    Furnace bare, covered;
    for (int i = 0; i < 12; ++i) {
        OpenPbrParams p = cube(false, false, true);
        p.geometryThinWalled = false;
        p.baseMetalness = p.subsurfaceWeight = number(0), p.transmissionWeight = number(1);
        if (i % 3 > 0) p.coatWeight = p.thinFilmWeight = number(0);
        (i % 3 > 0 ? bare : covered).add(p, 4000, i % 2, i % 4 < 2 ? &flat(1.33) : nullptr);
    }
    bare.report();
    covered.report();
    CHECK(bare.worst < 0.01);
    CHECK(bare.worstWithin < 0.01);
    CHECK(covered.worst < 0.005);
    CHECK(covered.worstWithin < 0.01);
}

TEST_CASE("no surface returns more than it receives, at any wavelength") {
    RandomOpenPbr cube(4);
    double most = 0;
    for (int i = 0; i < 100; ++i) {
        OpenPbrParams p = cube(i % 2, true, false);
        p.baseColor = color(flat(0.2)), p.coatColor = color(i % 3 ? white() : flat(0.2));
        p.transmissionColor = color(i % 4 ? white() : flat(0.2));
        const BsdfUnderTest b = openPbr(p, describe(p), Wavelengths::sample(0.4f));
        for (const double degrees : {5.0, 60.0, 85.0})
            for (const bool within : {false, true}) {
                if (within && b.eta == 0) continue;
                const Vec3 wo = within ? mirrored(directionAt(degrees)) : directionAt(degrees);
                for (const int lane : {0, 3, 6}) most = std::max(most, albedo(*b.bsdf, wo, 2000, lane));
            }
    }
    MESSAGE("largest albedo ", most);
    CHECK(most < 1.02);
}

} // namespace
} // namespace abbe

// Where the OpenPBR surface becomes one of the simple materials, and how it gets there.
#include "materials/openpbr_interface.h"
#include "openpbr_suite.h"
#include "support/analytic_textures.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

// Largest difference of values and densities over random pairs of directions, relative to the largest of the pair.
double difference(const BsdfUnderTest& a, const BsdfUnderTest& b, bool densities = true) {
    Random random(7);
    double worst = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 wo = squareToSphere({random.uniform(), random.uniform()});
        const auto s = b.bsdf->sample(wo, random.uniform(), {random.uniform(), random.uniform()}, Transport::radiance);
        if (!s || s->lobe.has(Lobe::delta) || std::min(std::abs(wo.z), std::abs(s->wi.z)) < 0.02f) continue;
        const BsdfEval x = a.bsdf->eval(wo, s->wi, Transport::radiance),
                       y = b.bsdf->eval(wo, s->wi, Transport::radiance);
        const auto compare = [&](float p, float q, float floor) {
            worst = std::max(worst, static_cast<double>(std::abs(p - q) / std::max({p, q, floor})));
        };
        compare(x.fcos[0], y.fcos[0], 0.01f);
        if (densities) compare(x.pdfSolidAngle, y.pdfSolidAngle, 0.01f);
    }
    return worst;
}

TEST_CASE("metalness 1 with a measured index is the conductor, round and stretched") {
    for (const float roughness : {0.2f, 0.6f, 1.f})
        for (const float anisotropy : {0.f, 0.6f}) {
            OpenPbrParams p;
            p.baseMetalness = number(1);
            p.baseMetalIndex = {&flat(0.2), &flat(3)};
            p.specularRoughness = number(static_cast<double>(roughness));
            p.specularRoughnessAnisotropy = number(static_cast<double>(anisotropy));
            CHECK(difference(openPbr(p, "openpbr"), conductor(0.2, 3, roughness, anisotropy)) < 2e-3);
        }
    OpenPbrParams p;
    p.baseMetalness = number(1), p.specularRoughness = number(0);
    p.baseMetalIndex = {&flat(0.2), &flat(3)};
    const BsdfUnderTest a = openPbr(p, "mirror"), b = conductor(0.2, 3, 0);
    const auto x = a.bsdf->sample(directionAt(50), 0.5f, {}, Transport::radiance),
               y = b.bsdf->sample(directionAt(50), 0.5f, {}, Transport::radiance);
    CHECK(x->wi == y->wi);
    CHECK(x->weight[0] == doctest::Approx(y->weight[0]));
    CHECK(x->pdfSolidAngle == 1);
    CHECK(a.bsdf->lobes() == b.bsdf->lobes());
}

TEST_CASE("transmission-weight 1 is the dielectric, from both sides") {
    for (const float roughness : {0.2f, 0.5f, 1.f}) {
        OpenPbrParams p;
        p.transmissionWeight = number(1), p.specularRoughness = number(static_cast<double>(roughness));
        CHECK(difference(openPbr(p, "openpbr"), dielectric(1.5, roughness)) < 1e-3);
    }
    OpenPbrParams p;
    p.transmissionWeight = number(1), p.specularRoughness = number(0);
    const BsdfUnderTest a = openPbr(p, "glass"), b = dielectric(1.5, 0);
    for (const Vec3 wo : {directionAt(40), mirrored(directionAt(30)), mirrored(directionAt(60))})
        for (const float u : {0.f, 0.5f, kOneMinusEpsilon}) {
            const auto x = a.bsdf->sample(wo, u, {}, Transport::radiance),
                       y = b.bsdf->sample(wo, u, {}, Transport::radiance);
            REQUIRE(x.has_value() == y.has_value());
            CHECK(length(x->wi - y->wi) < 1e-6f);
            CHECK(x->weight[0] == doctest::Approx(y->weight[0]).epsilon(1e-5));
            CHECK(x->eta == doctest::Approx(y->eta));
        }
}

TEST_CASE("specular-weight is the factor of the reflectance at normal incidence, above 1 up to all of it") {
    const Vec3 up{0, 0, 1};
    for (const double weight : {0.0, 0.5, 1.0, 4.0, 1000.0})
        for (const double coat : {0.0, 1.0}) {
            OpenPbrParams p;
            p.transmissionWeight = number(1), p.specularRoughness = number(0), p.specularWeight = number(weight);
            p.coatWeight = number(coat), p.coatColor = color(flat(0)); // black: what is below the coat is not seen
            const BsdfUnderTest glass = openPbr(p, "glass");
            const float f0 = 0.04f, coated = square(0.6f / 2.6f);
            const float expected = coat > 0 ? coated : std::min(1.f, f0 * static_cast<float>(weight));
            CHECK(glass.bsdf->evalDelta(up, up).ratio[0] == doctest::Approx(expected).epsilon(1e-3));
            p.coatWeight = number(0), p.baseMetalness = number(1), p.baseColor = color(flat(0.2));
            CHECK(openPbr(p, "metal").bsdf->evalDelta(up, up).ratio[0] ==
                  doctest::Approx(std::min(1.f, 0.2f * static_cast<float>(weight))).epsilon(1e-3));
        }
    // Under a coat the ratio to the coat counts: of the same index as the base, nothing is left to modulate.
    OpenPbrParams p;
    p.transmissionWeight = number(1), p.specularRoughness = number(0), p.specularWeight = number(3);
    p.coatWeight = number(1), p.coatIor = number(1.5);
    CHECK(openPbr(p, "matched").bsdf->evalDelta(up, up).ratio[0] == doctest::Approx(0.04).epsilon(1e-3));
}

TEST_CASE("coat-ior, thin-film-ior and the film's map as textures are what numbers are") {
    const auto same = [](void (*textured)(OpenPbrParams&, const Texture&), void (*plain)(OpenPbrParams&),
                         double value) {
        const auto v = static_cast<float>(value);
        const Constant texture({v, v, v});
        OpenPbrParams a, b;
        a.coatWeight = b.coatWeight = a.thinFilmWeight = b.thinFilmWeight = number(0.7);
        a.coatRoughness = b.coatRoughness = number(0.3);
        textured(a, texture), plain(b);
        CHECK(difference(openPbr(a, "texture"), openPbr(b, "number")) < 1e-4);
        CHECK(makeOpenPbr(a)->usesTextures());
    };
    same([](OpenPbrParams& p, const Texture& t) { p.coatIor.texture = &t; },
         [](OpenPbrParams& p) { p.coatIor = number(1.9); }, 1.9);
    same([](OpenPbrParams& p, const Texture& t) { p.thinFilmIor.texture = &t; },
         [](OpenPbrParams& p) { p.thinFilmIor = number(2.1); }, 2.1);
    same([](OpenPbrParams& p, const Texture& t) { p.thinFilmMap.texture = &t; },
         [](OpenPbrParams& p) { p.thinFilmThickness = 0.3e-6; }, 0.6);
}

TEST_CASE("specular-weight 0 is matte: Lambert's law at roughness 0") {
    OpenPbrParams p;
    p.specularWeight = number(0), p.baseColor = color(flat(0.2));
    CHECK(difference(openPbr(p, "openpbr"), {"diffuse", makeDiffuse({{&flat(0.2), nullptr, {}}}), 1.f}, false) < 1e-5);
}

// Each parameter on its way to where it has no effect any more.
TEST_CASE("nothing jumps: coat, film, fuzz, dispersion, roughness, metal") {
    const auto near = [](void (*small)(OpenPbrParams&), void (*none)(OpenPbrParams&), bool glass, double bound) {
        OpenPbrParams a, b;
        a.transmissionWeight = b.transmissionWeight = number(glass ? 1 : 0);
        a.specularRoughness = b.specularRoughness = number(0.4);
        small(a), none(b);
        CHECK(difference(openPbr(a, "nearly"), openPbr(b, "without")) < bound);
    };
    const auto nothing = [](OpenPbrParams&) {};
    for (const bool glass : {false, true}) {
        near([](OpenPbrParams& p) { p.coatWeight = number(1e-4), p.coatRoughness = number(0.5); }, nothing, glass,
             2e-3);
        near([](OpenPbrParams& p) { p.thinFilmWeight = number(1), p.thinFilmThickness = 1e-13; }, nothing, glass, 5e-3);
        near([](OpenPbrParams& p) { p.thinFilmWeight = number(1e-5); }, nothing, glass, 5e-3);
        near([](OpenPbrParams& p) { p.fuzzWeight = number(1e-4); }, nothing, glass, 2e-3);
        near([](OpenPbrParams& p) { p.transmissionDispersionScale = 1e-6; }, nothing, glass, 2e-3);
        near([](OpenPbrParams& p) { p.baseMetalness = number(1e-5); }, nothing, glass, 2e-3);
    }
    near([](OpenPbrParams& p) { p.baseDiffuseRoughness = number(1e-4); }, nothing, false, 2e-3);
    near([](OpenPbrParams& p) { p.thinFilmWeight = number(1), p.baseMetalness = number(1), p.thinFilmThickness = 0; },
         [](OpenPbrParams& p) { p.baseMetalness = number(1); }, false, 1e-4);
}

TEST_CASE("roughness to 0: the lobe becomes the mirror's direction and share") {
    for (const bool glass : {false, true}) {
        OpenPbrParams p;
        p.transmissionWeight = number(glass ? 1 : 0), p.baseColor = color(flat(0));
        p.specularRoughness = number(0.0225);
        const BsdfUnderTest lobe = openPbr(p, "lobe");
        p.specularRoughness = number(0.0223);
        const BsdfUnderTest mirror = openPbr(p, "mirror");
        CHECK(!lobe.bsdf->lobes().has(Lobe::delta));
        CHECK(mirror.bsdf->lobes().has(Lobe::delta));
        const Vec3 wo = directionAt(45);
        const auto mean = [&](const BsdfUnderTest& b, auto f) {
            return meanOfSamples(*b.bsdf, wo, Transport::radiance, 20000, f);
        };
        const auto energy = [](const BsdfSample& s) { return static_cast<double>(s.weight[0]); };
        const auto sideways = [](const BsdfSample& s) { return static_cast<double>(s.weight[0] * s.wi.x); };
        CHECK(mean(lobe, energy) == doctest::Approx(mean(mirror, energy)).epsilon(1e-3));
        CHECK(mean(lobe, sideways) == doctest::Approx(mean(mirror, sideways)).epsilon(2e-3));
    }
}

TEST_CASE("the coat: its colour at normal incidence, and darkening as of an interfaced Lambertian") {
    const Vec3 up{0, 0, 1};
    const auto matte = [&](const OpenPbrParams& p) {
        return static_cast<double>(openPbr(p, "coated").bsdf->eval(up, up, Transport::radiance).fcos[0]);
    };
    OpenPbrParams p;
    p.specularWeight = number(0), p.baseColor = color(flat(0.2)), p.coatWeight = number(1);
    const double clear = matte(p);
    p.coatColor = color(flat(0.2));
    CHECK(matte(p) / clear == doctest::Approx(0.2).epsilon(1e-5));
    p.coatColor = {};
    p.coatDarkening = number(0);
    const double f0 = square(0.6 / 2.6), open = matte(p);
    CHECK(open == doctest::Approx((1 - f0) * 0.2 / kPiD).epsilon(2e-3)); // the base's interface under the coat is none
    const double returned = 1 - (1 - hemisphericalReflectance(1.6)) / (1.6 * 1.6);
    CHECK(clear / open == doctest::Approx((1 - returned) / (1 - 0.2 * returned)).epsilon(1e-4));
}

TEST_CASE("thin walls: a leaf sends half of its light through, a pane all the rest, straight on") {
    OpenPbrParams p = whiteOpenPbr();
    p.geometryThinWalled = true;
    p.subsurfaceWeight = number(1), p.specularWeight = number(0);
    const auto share = [&](const BsdfUnderTest& b, bool through) {
        return meanOfSamples(*b.bsdf, directionAt(30), Transport::radiance, 20000, [&](const BsdfSample& s) {
            return (s.wi.z < 0) == through ? static_cast<double>(s.weight[0]) : 0.0;
        });
    };
    const BsdfUnderTest leaf = openPbr(p, "leaf");
    CHECK(share(leaf, true) == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(share(leaf, false) == doctest::Approx(0.5).epsilon(1e-3));
    p.subsurfaceScatterAnisotropy = 0.5;
    CHECK(share(openPbr(p, "leaf"), true) == doctest::Approx(0.75).epsilon(1e-3));
    OpenPbrParams pane = whiteOpenPbr();
    pane.geometryThinWalled = true;
    pane.transmissionWeight = number(1), pane.specularRoughness = number(0);
    const auto s = openPbr(pane, "pane").bsdf->sample(directionAt(30), kOneMinusEpsilon, {}, Transport::radiance);
    REQUIRE(s);
    CHECK(s->wi == -directionAt(30));
    CHECK(s->eta == 1);
    const double r = 0.0415; // 30 degrees, n = 1.5: 4.15 %; both faces and all between: 2R/(1 + R)
    CHECK(share(openPbr(pane, "pane"), false) == doctest::Approx(2 * r / (1 + r)).epsilon(5e-3));
}

} // namespace
} // namespace abbe

// A clear coat over a base, and the gloss that it is made of.
#include "materials/gloss.h"
#include "materials/layered.h"
#include "materials/subsurface.h"
#include "sphere_checks.h"
#include "suite.h"
#include "support/analytic_textures.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

const ConstantCurve kUnitCurve(1), kNoCoat(1.00000001), kMiddle(0.4);

const Material& base(int which) {
    static const auto white = makeDiffuse({{&kUnitCurve, nullptr, {}}}),
                      grey = makeDiffuse({{&flat(0.2), nullptr, {}}});
    static const BsdfUnderTest metal = conductor(0, 3, 0.5f), copper = conductor(0.2, 3, 0.3f),
                               mirror = conductor(0, 3, 0);
    return *(which == 0   ? white.get()
             : which == 1 ? grey.get()
             : which == 2 ? metal.material.get()
             : which == 3 ? copper.material.get()
                          : mirror.material.get());
}

LayeredParams coat(const Curve& ior, float roughness) {
    LayeredParams params;
    params.ior = &ior;
    params.roughness.value = static_cast<double>(roughness);
    return params;
}

GlossRange even(double ior, float roughness) { return {ior, {static_cast<double>(roughness), nullptr, {}}}; }

// A texture that has one value everywhere.
struct Painted {
    explicit Painted(double x) : texture(Vec3(Vec3d(x, x, x))) {}
    void paint(double x) { texture = Constant(Vec3(Vec3d(x, x, x))); }
    operator schema::TexturedNumber() const { return {0, &texture, {}}; }
    operator schema::TexturedSpectrum() const { return {nullptr, &texture, {}}; }
    Constant texture;
};

BsdfUnderTest coated(const char* name, const LayeredParams& params, int which) {
    return {name, makeLayered(params, base(which)), which < 2 ? 0.3f : 0.15f};
}

std::vector<BsdfUnderTest> layeredSuite() {
    LayeredParams tinted = coat(flat(1.5), 0.4f);
    tinted.tint.curve = &kMiddle;
    std::vector<BsdfUnderTest> all;
    all.push_back(coated("rough coat on grey", coat(flat(1.5), 0.4f), 1));
    all.push_back(coated("rough coat on copper", coat(flat(2.4), 0.5f), 3));
    all.push_back(coated("tinted coat on white", tinted, 0));
    SubsurfaceParams skin;
    skin.ior = &flat(1.5);
    skin.roughness.value = 0.5;
    skin.boundary.word = "diffuse";
    all.emplace_back("boundary of skin", makeSubsurfaceSurface(skin), 0.25f, 1.0001f);
    return all;
}

double albedo(const Bsdf& b, Vec3 wo) {
    return meanOfSamples(b, wo, Transport::radiance, 40000, [](const BsdfSample& s) { return s.weight[0]; });
}

} // namespace

TEST_CASE("gloss: its table is the share that its samples reflect, and smooth it is Fresnel's") {
    for (const double ior : {1.33, 1.5, 2.4})
        for (const float roughness : {0.05f, 0.2f, 0.5f, 1.f}) {
            const GlossRange owner = even(ior, roughness);
            const Gloss gloss = owner.at({});
            double mean = 0;
            for (int i = 0; i < 40; ++i) {
                const float mu = (static_cast<float>(i) + 0.5f) / 40;
                const Vec3 wo{std::sqrt(1 - mu * mu), 0, mu};
                const EvenPoints points(20000);
                double sum = 0;
                for (int k = 0; k < 20000; ++k)
                    if (const auto wi = gloss.sample(wo, points(k).u))
                        sum += static_cast<double>(gloss.weight(wo, *wi));
                CHECK(std::abs(sum / 20000 - static_cast<double>(gloss.albedo(mu))) < 2e-3);
                mean += 2 * static_cast<double>(mu * gloss.albedo(mu)) / 40;
            }
            CHECK(std::abs(mean - static_cast<double>(gloss.meanAlbedo())) < 2e-3);
        }
    const GlossRange clear = even(1.5, 0), nothing = even(1, 0.3f);
    const Gloss smooth = clear.at({}), none = nothing.at({});
    CHECK(smooth.albedo(1) == doctest::Approx(0.04));
    CHECK(smooth.meanAlbedo() == doctest::Approx(0.0918).epsilon(0.002)); // of an index of 1.5
    CHECK(none.albedo(0.1f) == 0);
}

TEST_CASE("gloss: reflects what a whole interface of the same index reflects") {
    Random random(214);
    for (const double ior : {1.33, 2.4})
        for (const float roughness : {0.2f, 0.7f}) {
            const BsdfUnderTest whole = dielectric(ior, roughness);
            const GlossRange owner = even(ior, roughness);
            const Gloss gloss = owner.at({});
            for (int i = 0; i < 1000; ++i) {
                const Vec3 wo = squareToCosineHemisphere({random.uniform(), random.uniform()}),
                           wi = squareToCosineHemisphere({random.uniform(), random.uniform()});
                if (!(wo.z > 0.01f && wi.z > 0.01f)) continue;
                CHECK(gloss.eval(wo, wi).fcos ==
                      doctest::Approx(whole.bsdf->eval(wo, wi, Transport::radiance).fcos[0]).epsilon(1e-4));
            }
        }
}

TEST_CASE("a gloss of varying roughness: between its tables, too, the share that its samples reflect") {
    double worst = 0;
    for (const double ior : {1.33, 1.5, 2.4}) {
        Painted painted(0);
        const GlossRange owner(ior, painted); // its tables are for any texture, and take a second
        CHECK(owner.textured());
        for (const double roughness : {0.0, 0.015, 0.03, 0.06, 0.1, 0.19, 0.31, 0.52, 0.77, 0.98, 1.0}) {
            painted.paint(roughness);
            const Gloss gloss = owner.at({});
            for (const float mu : {0.05f, 0.1f, 0.2f, 0.4f, 0.7f, 1.f}) {
                const Vec3 wo{std::sqrt(1 - mu * mu), 0, mu};
                const EvenPoints points(20000);
                double sum = 0;
                if (gloss.smooth())
                    sum = 20000 * static_cast<double>(even(ior, 0).at({}).albedo(mu));
                else
                    for (int k = 0; k < 20000; ++k)
                        if (const auto wi = gloss.sample(wo, points(k).u))
                            sum += static_cast<double>(gloss.weight(wo, *wi));
                const double error = std::abs(sum / 20000 - static_cast<double>(gloss.albedo(mu)));
                CHECK_MESSAGE(error < 4e-3, "ior ", ior, " roughness ", roughness, " mu ", mu);
                worst = std::max(worst, error);
            }
            CHECK(std::abs(even(ior, static_cast<float>(roughness)).at({}).meanAlbedo() - gloss.meanAlbedo()) < 2e-3f);
        }
    }
    MESSAGE("largest error ", worst);
}

TEST_CASE("a coat by textures is the coat by the same numbers") {
    const Painted roughness(0.375), tint(0.4), scale(0.5), darkening(0.3); // 0.375: one of the tables
    LayeredParams painted = coat(flat(1.5), 0), plain = coat(flat(1.5), 0.375f), half = plain;
    const ConstantCurve sigma(1000), whole(0.4), root(std::sqrt(0.4));
    painted.roughness = roughness, painted.tint = tint, painted.thicknessScale = scale, painted.darkening = darkening;
    plain.tint.curve = &whole, plain.thicknessScale.value = 0.5, plain.darkening.value = 0.3;
    half.tint.curve = &root, half.darkening.value = 0.3;
    const auto compare = [](const LayeredParams& a, const LayeredParams& b) {
        for (const Vec3 wo : aroundTheSphere())
            CHECK(albedo(*coated("a", a, 1).bsdf, wo) ==
                  doctest::Approx(albedo(*coated("b", b, 1).bsdf, wo)).epsilon(1e-5));
    };
    CHECK(makeLayered(painted, base(1))->usesTextures());
    CHECK_FALSE(makeLayered(plain, base(1))->usesTextures());
    compare(painted, plain);
    compare(plain, half); // half as thick: the root of the tint
    painted.tint = {}, painted.absorption = &sigma, half.tint = {}, half.absorption = &sigma, half.thickness = 5e-5;
    compare(painted, half);
}

TEST_CASE("coats: chi-square of the samples") {
    Random random(211);
    checkChiSquare(layeredSuite(), random, chiSquareSamples(), [](const auto&, Vec3 wo, bool upper) {
        const Vec3 centre = upper == (wo.z > 0) ? wo : mirrored(wo);
        return HemisphereCells(upper, Vec3d{-centre.x, -centre.y, centre.z}, 0.25, 24, 24);
    });
}

TEST_CASE("coats: sample() returns the weight and the density that eval() gives") {
    Random random(212);
    for (const BsdfUnderTest& b : layeredSuite())
        for (const Vec3 wo : aroundTheSphere()) {
            const double worst = sampleAgainstEval(*b.bsdf, wo, random, 4000);
            CHECK_MESSAGE(worst < 2e-4 + 4e-6 / std::abs(static_cast<double>(wo.z)), b.name, " wo.z ", wo.z, ": ",
                          worst);
        }
}

TEST_CASE("coats: a white furnace over roughness, index and base, within half a percent") {
    double worst = 0;
    for (const int which : {0, 2, 4})
        for (const double ior : {1.33, 1.5, 2.4})
            for (const float roughness : {0.f, 0.05f, 0.2f, 0.5f, 1.f}) {
                const BsdfUnderTest b = coated("lossless", coat(flat(ior), roughness), which);
                for (const double angle : {2.0, 30.0, 50.0, 65.0, 75.0, 82.0, 87.0}) {
                    const double e = albedo(*b.bsdf, directionAt(angle));
                    CHECK_MESSAGE(std::abs(e - 1) < 5e-3, "base ", which, " ior ", ior, " roughness ", roughness,
                                  " at ", angle, ": ", e);
                    worst = std::max(worst, std::abs(e - 1));
                }
            }
    MESSAGE("largest error ", worst);
}

TEST_CASE("coats darken what is between black and white, as an ideal diffuser under a smooth coat shows") {
    // Saunderson's equation for light that has been let in: (1 - E)(1 - K) ρ/(1 - K ρ) [Saunderson1942].
    const BsdfUnderTest b = coated("grey", coat(flat(1.5), 0), 1);
    const double e = 0.04, k = 1 - (1 - 0.0918) / 2.25, rho = 0.2;
    CHECK(albedo(*b.bsdf, {0, 0, 1}) == doctest::Approx(e + (1 - e) * (1 - k) * rho / (1 - k * rho)).epsilon(0.03));
    LayeredParams off = coat(flat(1.5), 0);
    off.darkening.value = 0;
    CHECK(albedo(*coated("grey", off, 1).bsdf, {0, 0, 1}) == doctest::Approx(e + (1 - e) * rho).epsilon(0.002));
}

TEST_CASE("a coat without an index is no coat, and as the index falls to 1 it fades away") {
    Arena arena;
    const Wavelengths lambda = Wavelengths::single(550);
    Random random(213);
    for (const int which : {1, 3}) {
        const Bsdf& bare = *base(which).bsdf({}, lambda, arena);
        double before = 1;
        for (const double ior : {1.3, 1.1, 1.03, 1.01, 1.001, 1.0}) {
            const ConstantCurve n(ior);
            const BsdfUnderTest b = coated("fading", coat(n, 0.4f), which);
            double worst = 0;
            Random same(5);
            for (int i = 0; i < 2000; ++i) {
                const Vec3 wo = squareToCosineHemisphere({same.uniform(), same.uniform()}),
                           wi = squareToCosineHemisphere({same.uniform(), same.uniform()});
                const float f = b.bsdf->eval(wo, wi, Transport::radiance).fcos[0],
                            g = bare.eval(wo, wi, Transport::radiance).fcos[0];
                if (wo.z > 0.1f) worst = std::max(worst, static_cast<double>(std::abs(f - g)));
            }
            CHECK(worst <= before);
            before = worst + 1e-12;
            if (ior == 1.0) CHECK(worst == 0);
        }
    }
}

TEST_CASE("the tint is what is left straight in and out, and obliquely less") {
    LayeredParams tinted = coat(kNoCoat, 0.4f);
    tinted.tint.curve = &kMiddle;
    CHECK(albedo(*coated("mirror", tinted, 4).bsdf, {0, 0, 1}) == doctest::Approx(0.4).epsilon(1e-4));
    LayeredParams thick = coat(flat(1.5), 0);
    const ConstantCurve sigma(1000);
    thick.absorption = &sigma;
    thick.thickness = 1e-3;
    thick.darkening.value = 0;
    const double mu = std::cos(50 * kPiD / 180), inside = std::sqrt(1 - (1 - mu * mu) / 2.25);
    const BsdfUnderTest b = coated("mirror", thick, 4);
    const double gloss = static_cast<double>(even(1.5, 0).at({}).albedo(static_cast<float>(mu)));
    CHECK(albedo(*b.bsdf, directionAt(50)) ==
          doctest::Approx(gloss + (1 - gloss) * std::exp(-2 / inside)).epsilon(2e-3));
}

TEST_CASE("coats at every cosine and number are finite") {
    for (const BsdfUnderTest& b : layeredSuite()) CHECK_MESSAGE(heaviestAtExtremes(*b.bsdf) < kInfinity, b.name);
}

} // namespace abbe

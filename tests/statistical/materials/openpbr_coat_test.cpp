// The coat of an OpenPBR surface with a normal and a tangent of its own.
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "openpbr_suite.h"
#include "support/analytic_textures.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

using namespace test;

Constant directions(Vec3 d) { return Constant(d * 0.5f + Vec3{0.5f, 0.5f, 0.5f}); }

const Vec3 kLeaning = normalize(Vec3{0.25f, -0.15f, 1});

// On the plane z = 0 with u along x and v along y, its shading normal bent to `bent`, seen from wo.
SurfaceHit planeHit(Vec3 wo, Vec3 bent = {0, 0, 1}) {
    SurfaceHit hit;
    hit.ng = hit.localNormal = {0, 0, 1};
    hit.dpdu = {1, 0, 0}, hit.dpdv = {0, 1, 0};
    hit.shading = Frame::fromNormalTangent(bent, hit.dpdu);
    hit.arrival = -wo;
    return hit;
}

struct Coated {
    Coated(const OpenPbrParams& p, Vec3 wo, Vec3 bent = {0, 0, 1})
        : frame(planeHit(wo, bent).shading), material(makeOpenPbr(p)),
          bsdf(material->bsdf(planeHit(wo, bent), Wavelengths::single(550), arena)) {}
    double value(Vec3 wo, Vec3 wi) const {
        return static_cast<double>(bsdf->eval(frame.toLocal(wo), frame.toLocal(wi), Transport::radiance).fcos[0]);
    }

    Frame frame;
    std::unique_ptr<const Material> material;
    Arena arena;
    const Bsdf* bsdf;
};

// The base is stretched along its own tangent, the coat along u whatever that is.
TEST_CASE("geometry-tangent turns the highlight of the base alone") {
    const Vec3 wo = normalize(Vec3{0.3f, 0.2f, 1}), wi = normalize(Vec3{-0.1f, 0.4f, 1});
    const auto turned = [](Vec3 w) { return Vec3{w.y, -w.x, w.z}; }; // by -90 degrees
    const Constant alongV = directions({0, 1, 0});
    OpenPbrParams p;
    p.baseMetalness = number(1), p.specularRoughness = number(0.5), p.specularRoughnessAnisotropy = number(0.8);
    const auto value = [&](const OpenPbrParams& of, Vec3 o, Vec3 i) {
        const auto material = makeOpenPbr(of);
        SurfaceHit hit = planeHit(o);
        REQUIRE(material->usesTextures() == material->bends());
        if (material->bends()) material->bend(hit);
        Arena arena;
        const Bsdf* bsdf = material->bsdf(hit, Wavelengths::single(550), arena);
        return static_cast<double>(
            bsdf->eval(hit.shading.toLocal(o), hit.shading.toLocal(i), Transport::radiance).fcos[0]);
    };
    const double plain = value(p, wo, wi), across = value(p, turned(wo), turned(wi));
    CHECK(std::abs(plain / across - 1) > 0.2);
    OpenPbrParams number90 = p, map = p;
    number90.geometryTangent = number(0.25), map.geometryTangent.texture = &alongV;
    CHECK(value(number90, wo, wi) == doctest::Approx(across).epsilon(1e-4));
    CHECK(value(map, wo, wi) == doctest::Approx(across).epsilon(1e-4));
    // Round highlights have no direction.
    number90.specularRoughnessAnisotropy = number(0);
    CHECK(!makeOpenPbr(number90)->bends());
}

OpenPbrParams lacquer(double roughness) {
    OpenPbrParams p;
    p.baseColor = color(flat(0.2)), p.specularWeight = number(0);
    p.coatWeight = number(1), p.coatRoughness = number(roughness);
    return p;
}

// The share of the samples, by weight, that `pick` says.
template <typename F> double shareOf(const Bsdf& bsdf, Vec3 wo, F&& pick) {
    return meanOfSamples(bsdf, wo, Transport::radiance, 40000,
                         [&](const BsdfSample& s) { return pick(s) ? static_cast<double>(s.weight[0]) : 0.0; });
}

TEST_CASE("a polished coat mirrors at its own normal, from both sides of a sheet") {
    const Constant leaning = directions(kLeaning);
    OpenPbrParams p = lacquer(0);
    p.geometryCoatNormal.texture = &leaning;
    p.geometryThinWalled = true;
    for (const bool back : {false, true}) {
        const Vec3 wo = back ? mirrored(directionAt(30)) : directionAt(30), n = back ? -kLeaning : kLeaning;
        const Coated c(p, wo);
        int mirrors = 0;
        for (int i = 0; i < 64; ++i) {
            const auto s = c.bsdf->sample(wo, (static_cast<float>(i) + 0.5f) / 64, {0.3f, 0.6f}, Transport::radiance);
            if (!s || !s->lobe.has(Lobe::delta)) continue;
            ++mirrors;
            CHECK(length(s->wi - reflect(wo, n)) < 1e-5f);
        }
        CHECK(mirrors > 0);
        const double f = static_cast<double>(fresnelDielectric(Spectrum(dot(wo, n)), Spectrum(1.6f))[0]);
        CHECK(shareOf(*c.bsdf, wo, [](const BsdfSample& s) { return s.lobe.has(Lobe::delta); }) ==
              doctest::Approx(f).epsilon(2e-3));
    }
}

TEST_CASE("a flat map, and a coat that follows the base, change nothing") {
    const Constant upright = directions({0, 0, 1});
    for (const double roughness : {0.2, 0.6}) {
        OpenPbrParams p = lacquer(roughness);
        p.coatRoughnessAnisotropy = number(0.5), p.coatColor = color(flat(0.2));
        const Vec3 wo = directionAt(50), bent = normalize(Vec3{0.1f, 0.2f, 1});
        const Coated plain(p, wo), plainBent(p, wo, bent);
        p.geometryCoatTangent = number(1); // once around: the frame is made, but the same
        const Coated follows(p, wo, bent);
        p.geometryCoatNormal.texture = &upright;
        const Coated flatMap(p, wo);
        for (const double degrees : {10.0, 45.0, 80.0})
            for (const double azimuth : {0.0, 2.0, 4.0}) {
                const Vec3 wi = directionAt(degrees, azimuth);
                CHECK(flatMap.value(wo, wi) == doctest::Approx(plain.value(wo, wi)).epsilon(1e-4));
                CHECK(follows.value(wo, wi) == doctest::Approx(plainBent.value(wo, wi)).epsilon(1e-4));
            }
    }
}

TEST_CASE("a smooth coat over a bumpy base mirrors at the shape's own normal, and halfway in between") {
    const Vec3 wo = directionAt(20), bent = normalize(Vec3{0.3f, 0, 1});
    OpenPbrParams p = lacquer(0);
    for (const double follow : {0.0, 0.5}) {
        p.geometryCoatNormal = number(follow);
        const Coated c(p, wo, bent);
        const auto s = c.bsdf->sample(c.frame.toLocal(wo), 0, {0.5f, 0.5f}, Transport::radiance);
        REQUIRE(s);
        REQUIRE(s->lobe.has(Lobe::delta));
        const Vec3 n = normalize(Vec3{0, 0, 1} * (follow == 0 ? 1 : 0.5f) + bent * (follow == 0 ? 0 : 0.5f));
        CHECK(length(c.frame.toWorld(s->wi) - reflect(wo, n)) < 1e-5f);
    }
}

TEST_CASE("the coat's tangent: a quarter of a turn exchanges its widths, by number and by texture") {
    const Vec3 wo = directionAt(40, 0.7);
    const auto turned = [](Vec3 w) { return Vec3{w.y, -w.x, w.z}; };
    const Constant alongV = directions({0, 1, 0});
    OpenPbrParams p = lacquer(0.4);
    p.coatRoughnessAnisotropy = number(0.8);
    const Coated plain(p, turned(wo));
    p.geometryCoatTangent = number(0.25);
    const Coated byNumber(p, wo);
    p.geometryCoatTangent.texture = &alongV;
    const Coated byTexture(p, wo);
    for (const double azimuth : {0.5, 3.0, 4.0}) {
        const Vec3 wi = directionAt(45, azimuth);
        CHECK(byNumber.value(wo, wi) == doctest::Approx(plain.value(turned(wo), turned(wi))).epsilon(1e-4));
        CHECK(byTexture.value(wo, wi) == doctest::Approx(plain.value(turned(wo), turned(wi))).epsilon(1e-4));
    }
}

TEST_CASE("directions are not read from heights") {
    const UvWave heights;
    OpenPbrParams p;
    p.geometryCoatNormal.texture = p.geometryCoatTangent.texture = &heights;
    Diagnostics diagnostics;
    CHECK(!checkParams(
        p, [](std::string_view) { return Span{}; }, diagnostics));
    REQUIRE(diagnostics.all().size() == 2);
    for (const Diagnostic& d : diagnostics.all()) CHECK(d.code == "E0705");
}

TEST_CASE("a leaning coat: sample() and eval() agree, no light is made, little is lost") {
    const Constant leaning = directions(kLeaning);
    for (const int kind : {0, 1, 2})
        for (const Vec3 wo : {directionAt(15), directionAt(50, 2), directionAt(70, 4)}) {
            OpenPbrParams p = whiteOpenPbr();
            p.baseMetalness = number(kind == 1), p.specularRoughness = number(0.4);
            p.coatIor = number(kind == 2 ? 6 : 1.6); // most of the light is the coat's
            p.coatWeight = number(0.8), p.coatRoughness = number(0.3);
            p.geometryCoatNormal.texture = &leaning;
            const Coated c(p, wo);
            const BsdfUnderTest cellsOf("leaning", makeOpenPbr(p), 0.1f);
            double density = 0, light = 0, worst = 0;
            const auto cells = cellsFor(cellsOf, wo, true);
            const auto over = [&](auto&& f) { return cells.integral([&](Vec3d wi) { return f(Vec3(wi)); }); };
            density = over(
                [&](Vec3 wi) { return static_cast<double>(c.bsdf->eval(wo, wi, Transport::radiance).pdfSolidAngle); });
            light = over([&](Vec3 wi) { return c.value(wo, wi); });
            Random random(3);
            for (int i = 0; i < 10000; ++i) {
                const float u = random.uniform();
                const auto s = c.bsdf->sample(wo, u, {random.uniform(), random.uniform()}, Transport::radiance);
                if (!s) continue;
                const BsdfEval e = c.bsdf->eval(wo, s->wi, Transport::radiance);
                worst = std::max(worst, static_cast<double>(std::abs(e.fcos[0] / e.pdfSolidAngle / s->weight[0] - 1)));
            }
            CHECK(worst < 1e-3);
            const double kept =
                meanOfSamples(*c.bsdf, wo, Transport::radiance, 40000, [](const BsdfSample&) { return 1.0; });
            CHECK(density == doctest::Approx(kept).epsilon(2e-3));
            CHECK(shareOf(*c.bsdf, wo, [](const BsdfSample&) { return true; }) == doctest::Approx(light).epsilon(3e-3));
            CHECK(light < 1.005);
            CHECK(light > (kind == 2 ? 0.9 : 0.97));
        }
}

} // namespace
} // namespace abbe

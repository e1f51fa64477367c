// What each material is: its lobes, sides, effects and parameter table.
#include "materials/conductor.h"
#include "materials/dielectric.h"
#include "materials/diffuse.h"
#include "materials/fresnel.h"
#include "spectrum/curve.h"
#include "support/ggx_reference.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

const ConstantCurve kGlass(1.5), kHalf(0.5), kThree(3);

class Sloped final : public Curve {
  public:
    Spectrum at(const Wavelengths& w) const override { return Spectrum(1.8f - 0.0004f * w.nm.v); }
    double at(double nm) const override { return 1.8 - 0.0004 * nm; }
    bool isConstant() const override { return false; }
    double minimum() const override { return at(830); }
    double maximum() const override { return at(360); }
};

const Bsdf& bsdfOf(const Material& m, Arena& arena, Wavelengths w = Wavelengths::single(550)) {
    return *m.bsdf({}, w, arena);
}

DielectricParams ofIndex(const Curve& ior) {
    DielectricParams params;
    params.ior = &ior;
    return params;
}

Vec3 down(Vec3 w) { return {w.x, w.y, -w.z}; }

TEST_CASE("diffuse: the same from both sides, nothing through") {
    Arena arena;
    const auto material = makeDiffuse({{&kHalf, nullptr, {}}});
    const Bsdf& b = bsdfOf(*material, arena);
    const Vec3 wo = normalize(Vec3{1, 2, 3}), wi = normalize(Vec3{-2, 1, 1});
    CHECK(b.eval(wo, wi, Transport::radiance).fcos[0] == doctest::Approx(0.5 * wi.z / kPiD));
    CHECK(b.eval(down(wo), down(wi), Transport::radiance).fcos[0] == b.eval(wo, wi, Transport::radiance).fcos[0]);
    CHECK(b.eval(wo, down(wi), Transport::radiance).pdfSolidAngle == 0);
    CHECK(b.sample(down(wo), 0.5f, {0.3f, 0.4f}, Transport::radiance)->wi.z < 0);
    CHECK(material->needs().empty());
    const auto plain = makeDiffuse({});
    CHECK(bsdfOf(*plain, arena).sample(wo, 0, {0.5f, 0.5f}, Transport::radiance)->weight[0] == 0.5f);
}

TEST_CASE("polished metal is a mirror with Fresnel's reflectance, never evaluated (case 39)") {
    Arena arena;
    ConductorParams polished;
    polished.index = {&kHalf, &kThree};
    const auto material = makeConductor(polished);
    const Bsdf& b = bsdfOf(*material, arena);
    const Vec3 wo = normalize(Vec3{1, 2, 3});
    const auto s = b.sample(wo, 0.5f, {0.1f, 0.9f}, Transport::radiance);
    REQUIRE(s);
    CHECK(s->wi == Vec3{-wo.x, -wo.y, wo.z});
    CHECK(s->lobe.has(Lobe::delta));
    CHECK(s->weight[0] == doctest::Approx(test::referenceFresnel(static_cast<double>(wo.z), 0.5, 3)).epsilon(1e-5));
    CHECK(b.eval(wo, s->wi, Transport::radiance).pdfSolidAngle == 0);
}

TEST_CASE("refraction obeys Snell's law to 1e-6 rad") {
    Arena arena;
    test::Random random(1);
    const auto material = makeDielectric(ofIndex(kGlass));
    const Bsdf& b = bsdfOf(*material, arena);
    for (int i = 0; i < 5000; ++i) {
        const double sinO = random.uniformDouble() * (i % 2 ? 1 : 0.66), phi = 6.283 * random.uniformDouble();
        const double side = i % 2 ? 1 : -1, eta = i % 2 ? 1.5 : 1 / 1.5;
        const Vec3 wo(Vec3d{sinO * std::cos(phi), sinO * std::sin(phi), side * std::sqrt(1 - sinO * sinO)});
        const auto s = b.sample(wo, kOneMinusEpsilon, {}, Transport::radiance);
        if (!s || s->wi.z * wo.z > 0) continue;
        const Vec3d o = normalize(Vec3d(wo)), t = normalize(Vec3d(s->wi));
        CHECK(std::abs(std::hypot(t.x, t.y) - std::hypot(o.x, o.y) / eta) < 2e-7);
        CHECK(length(cross(normalize(Vec3d{t.x, t.y, 0}), normalize(Vec3d{o.x, o.y, 0}))) * std::hypot(t.x, t.y) <
              2e-7);
        CHECK(s->eta == doctest::Approx(eta));
    }
}

TEST_CASE("polished glass: shares, total reflection and the compression of radiance") {
    Arena arena;
    const auto material = makeDielectric(ofIndex(kGlass));
    const Bsdf& b = bsdfOf(*material, arena);
    const Vec3 wo{0, 0.6f, 0.8f};
    const float r = fresnelDielectric(0.8f, 1.5f);
    const auto reflected = b.sample(wo, 0.99f * r, {}, Transport::radiance);
    CHECK(reflected->wi == Vec3{0, -0.6f, 0.8f});
    CHECK(reflected->pdfSolidAngle == doctest::Approx(r));
    CHECK(reflected->weight[0] == doctest::Approx(1));
    const auto refracted = b.sample(wo, 1.01f * r, {}, Transport::radiance);
    CHECK(refracted->weight[0] == doctest::Approx(1 / 2.25));
    CHECK(b.sample(wo, 1.01f * r, {}, Transport::importance)->weight[0] == doctest::Approx(1));
    for (const float u : {0.f, 0.5f, kOneMinusEpsilon}) // from inside at 53 degrees, beyond the critical 42
        CHECK(b.sample({0, 0.8f, -0.6f}, u, {}, Transport::radiance)->wi == Vec3{0, -0.8f, -0.6f});
    CHECK(!b.lobes().has(Lobe::dispersive));
}

TEST_CASE("an index of 1 is no interface, polished or rough") {
    Arena arena;
    const ConstantCurve one(1), almost(1.0000004);
    for (const Curve* ior : {static_cast<const Curve*>(&one), static_cast<const Curve*>(&almost)})
        for (const float roughness : {0.f, 0.5f}) {
            DielectricParams params;
            params.ior = ior;
            params.roughness.value = roughness;
            const auto material = makeDielectric(params);
            for (const Vec3 wo : {Vec3{0, 0.6f, 0.8f}, Vec3{0, 0.6f, -0.8f}, Vec3{1, 0, 0}}) {
                const auto s = bsdfOf(*material, arena).sample(wo, 0, {}, Transport::radiance);
                REQUIRE(s);
                CHECK(s->wi == -wo);
                CHECK(s->weight[0] == 1);
            }
        }
}

TEST_CASE("effects: asked for by what varies, and by what absorbs") {
    const Sloped sloped;
    CHECK(makeDielectric(ofIndex(kGlass))->needs().empty());
    CHECK(makeDielectric(ofIndex(sloped))->needs() == Effects(Effect::dispersion));
    DielectricParams tinted;
    tinted.attenuationColor = &kHalf;
    tinted.attenuationDistance = 0.02;
    const auto material = makeDielectric(tinted);
    CHECK(material->needs() == Effects(Effect::absorption));
    REQUIRE(material->absorption());
    CHECK(material->absorption()->at(550.0) == doctest::Approx(std::log(2) / 0.02));
    CHECK(material->absorption()->at(Wavelengths::single(550))[3] == doctest::Approx(std::log(2) / 0.02));
    const ConstantCurve black(0);
    tinted.attenuationColor = &black;
    CHECK(makeDielectric(tinted)->absorption()->at(Wavelengths::single(550))[0] == doctest::Approx(13.8155 / 0.02));
    CHECK(makeDielectric(ofIndex(kGlass))->absorption() == nullptr);
}

TEST_CASE("dispersion shows only where the lanes differ") {
    Arena arena;
    const Sloped sloped;
    for (const float roughness : {0.f, 0.4f}) {
        DielectricParams params;
        params.ior = &sloped;
        params.roughness.value = roughness;
        const auto material = makeDielectric(params);
        CHECK(bsdfOf(*material, arena, Wavelengths::sample(0.1f)).lobes().has(Lobe::dispersive));
        CHECK(!bsdfOf(*material, arena).lobes().has(Lobe::dispersive));
    }
}

TEST_CASE("parameter tables say what they must, and store what they read") {
    for (const schema::TypeInfo& type : {diffuseType(), conductorType(), dielectricType()}) {
        CHECK(type.kind == schema::Kind::material);
        CHECK(type.example.find(type.name) != std::string_view::npos);
        for (const schema::FieldInfo& field : type.fields) {
            CHECK(field.doc.ends_with("."));
            CHECK(field.example.starts_with(field.name));
            CHECK(field.store);
        }
    }
    ConductorParams params;
    for (const schema::FieldInfo& field : conductorType().fields) {
        if (field.name == "roughness") field.store(&params, schema::BoundValue(0.25));
        if (field.name == "index") field.store(&params, schema::BoundValue(schema::ComplexIndex{&kHalf, &kThree}));
    }
    CHECK(params.roughness.value == 0.25);
    CHECK(params.index.k == &kThree);
}

} // namespace
} // namespace abbe

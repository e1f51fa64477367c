// What any material may wear: opacity, normal and bump maps, priority.
#include "materials/diffuse.h"
#include "math/warp.h"
#include "scene/wrapped_materials.h"
#include "scene_test_fixture.h"
#include "support/analytic_textures.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

NumberInput number(double value) { return NumberInput(schema::TexturedNumber{value, nullptr, {}}, 0, 1); }

const Material& plain() {
    static const auto material = makeDiffuse({});
    return *material;
}

// A point of a skewed chart, seen from above.
SurfaceHit chart() {
    SurfaceHit hit;
    hit.ng = normalize(Vec3{0.2f, -0.1f, 1});
    hit.shading = Frame::fromNormal(hit.ng);
    hit.dpdu = hit.shading.x * 2.f + hit.shading.y * 0.5f;
    hit.dpdv = hit.shading.x * -0.3f + hit.shading.y * 0.7f;
    hit.uv = {0.37f, 0.81f};
    hit.local = {0.3f, -0.2f, 0.5f};
    hit.arrival = -normalize(hit.ng + hit.shading.x * 0.1f);
    return hit;
}

// The normal of the surface p(u, v) + height · h(p) n by differences, in double.
template <typename H> Vec3d raised(const SurfaceHit& hit, double height, H&& h) {
    const double step = 1e-4;
    const Vec3d n(hit.ng), u(hit.dpdu), v(hit.dpdv);
    const auto point = [&](double du, double dv) { return u * du + v * dv + n * (height * h(du, dv)); };
    return normalize(cross(point(step, 0) - point(-step, 0), point(0, step) - point(0, -step)));
}

const Material& materialAt(const TestScene& scene) { return *trace(scene, {0, 0, 5}, {0, 0, -1}).hit.material; }

std::string sphere(const std::string& material) { return "shape sphere { material " + material + " }\n"; }

} // namespace

TEST_CASE("a bump by texture coordinates has the normals of the raised surface") {
    const SurfaceHit hit = chart();
    const UvWave wave;
    const auto h = [&](double du, double dv) {
        return std::sin(wave.fu * (static_cast<double>(hit.uv.x) + du) + 0.3) *
               std::cos(wave.fv * (static_cast<double>(hit.uv.y) + dv) - 0.2);
    };
    for (const double height : {0.05, -0.3, 1.0}) {
        const Vec3 n = bumpedNormal({&wave, static_cast<float>(height)}, hit);
        // The chart is flat, but its raised points also tilt with the wave: exact for any height.
        CHECK(length(Vec3d(n) - raised(hit, height, h)) < 2e-4);
    }
}

TEST_CASE("a bump in space follows the shape's own space, turned and scaled") {
    SurfaceHit hit = chart();
    // local = A p: the gradients of its coordinates are the rows of A.
    hit.localX = {0, 3, 0.2f};
    hit.localY = {-2, 0, 0};
    hit.localZ = {0.1f, 0, 0.5f};
    const SpaceWave wave;
    const auto h = [&](double du, double dv) {
        const Vec3d p = Vec3d(hit.dpdu) * du + Vec3d(hit.dpdv) * dv;
        const Vec3d local =
            Vec3d(hit.local) + Vec3d(dot(Vec3d(hit.localX), p), dot(Vec3d(hit.localY), p), dot(Vec3d(hit.localZ), p));
        return SpaceWave::at(local, wave.f).x;
    };
    CHECK(length(Vec3d(bumpedNormal({&wave, 0.2f}, hit)) - raised(hit, 0.2, h)) < 2e-4);
    hit.dpdu = hit.dpdv = {};
    const Vec3 without = bumpedNormal({&wave, 0.2f}, hit); // no texture coordinates are needed
    hit = chart();
    hit.localX = {0, 3, 0.2f};
    hit.localY = {-2, 0, 0};
    hit.localZ = {0.1f, 0, 0.5f};
    CHECK(length(without - bumpedNormal({&wave, 0.2f}, hit)) < 1e-6f);
}

TEST_CASE("a normal map: flat is flat, x along u, y along v, mirrored coordinates too") {
    SurfaceHit hit = chart();
    const Constant flat({0.5f, 0.5f, 1}), right({0.75f, 0.5f, 1}), up({0.5f, 0.75f, 1});
    CHECK(length(mappedNormal({&flat, 1}, hit) - hit.ng) < 1e-6f);
    CHECK(length(mappedNormal({&right, 0}, hit) - hit.ng) < 1e-6f);
    for (const bool mirror : {false, true}) {
        if (mirror) hit.dpdv = -hit.dpdv;
        const Vec3 a = mappedNormal({&right, 1}, hit), b = mappedNormal({&up, 1}, hit);
        CHECK(dot(a, normalize(hit.dpdu)) == doctest::Approx(0.5 / std::sqrt(1.25)));
        CHECK(dot(b, hit.dpdu) == doctest::Approx(0).epsilon(1e-5));
        CHECK(dot(b, hit.dpdv) > 0);
        CHECK(dot(mappedNormal({&right, 2}, hit), normalize(hit.dpdu)) == doctest::Approx(std::sqrt(0.5)));
    }
    hit.dpdu = hit.dpdv = {};
    CHECK(mappedNormal({&right, 1}, hit) == hit.ng);
}

TEST_CASE("a dressed material bends into the hemisphere of the eye, over frames of every kind (case 42)") {
    Random random(5);
    for (int i = 0; i < 20000; ++i) {
        const auto direction = [&] { return squareToSphere({random.uniform(), random.uniform()}); };
        const Constant stored({random.uniform(), random.uniform(), random.uniform()});
        const SpaceWave wave;
        const ModifiedMaterial material(plain(), {number(1), {&stored, 20 * random.uniform()}, {&wave, 3}, 0});
        SurfaceHit hit = chart();
        hit.ng = direction();
        hit.shading = Frame::fromNormal(normalize(hit.ng + direction() * 0.9f));
        hit.dpdu = direction(), hit.dpdv = direction(), hit.arrival = direction();
        material.bend(hit);
        const Vec3 wo = -hit.arrival, n = hit.shading.z, wi = n * (2 * dot(n, wo)) - wo;
        CHECK(dot(n, hit.ng) > 0);
        if (std::abs(dot(wo, hit.ng)) > 1e-4f) CHECK(dot(wi, hit.ng) * dot(wo, hit.ng) > 0);
        CHECK(std::abs(dot(hit.shading.x, n)) < 1e-5f);
        CHECK(std::abs(length(hit.shading.y) - 1) < 1e-5f);
    }
}

TEST_CASE("what a material wears asks for effects, and what it does not wear costs nothing") {
    const auto undressed = build(sphere("diffuse { reflectance 0.3 }"));
    CHECK(dynamic_cast<const ModifiedMaterial*>(&materialAt(undressed)) == nullptr);
    CHECK(undressed.scene().effects.empty());
    const auto thin = build(sphere("diffuse { reflectance 0.3; opacity 40 % }"));
    CHECK(materialAt(thin).mayBeOpen());
    CHECK(materialAt(thin).opacity({}) == doctest::Approx(0.4));
    CHECK_FALSE(materialAt(thin).bends());
    CHECK(thin.scene().effects == Effects(Effect::interfaces));
    const auto bumpy = build(sphere("diffuse { bump 2 mm { map noise { scale 1 cm } } }"));
    CHECK(materialAt(bumpy).bends());
    CHECK(materialAt(bumpy).usesTextures());
    CHECK_FALSE(materialAt(bumpy).mayBeOpen());
    CHECK(bumpy.scene().effects.has(Effect::textures));
    const auto named =
        build("texture lumps noise\n" + sphere("conductor { index metal Au; normal lumps strength=0.5 }"));
    CHECK(named.report() == "");
    CHECK(materialAt(named).bends());
    // All that a material says goes through what it wears.
    const auto glass = build("medium milk homogeneous\nshape sphere { material dielectric { ior 1.4; opacity 0.5; "
                             "absorption 3 }; interior milk }\n");
    const Material& m = materialAt(glass);
    CHECK(m.absorption() != nullptr);
    CHECK(m.interior() != nullptr);
    CHECK(m.mayBeOpen());
    CHECK(m.needs().has(Effect::interfaces));
}

TEST_CASE("what a material cannot wear is said where it stands") {
    CHECK(codes(build(sphere("diffuse { opacity 1.5 }"))) == "E0303");
    CHECK(codes(build(sphere("diffuse { bump 2 mm }"))) == "E0207");
    CHECK(codes(build(sphere("diffuse { bump 2 { map noise }; bump 3 { map noise } }"))) == "E0208");
    CHECK(codes(build(sphere("diffuse { normal noise; normal noise }"))) == "E0208");
    CHECK(codes(build(sphere("diffuse { normal noise strength=-1 }"))) == "E0303");
    CHECK(codes(build(sphere("diffuse { normal nothing }"))) == "E0202");
    CHECK(codes(build(sphere("diffuse { priority 2 }"))) == "E0721");
    CHECK(codes(build(sphere("diffuse { priority 2.5 }"))) == "E0305");
    CHECK(codes(build(sphere("boundary { opacity 0.5 }"))) == "E0201");
    CHECK(codes(build("shape sphere { emission 3; material diffuse { opacity 0.5 } }\n")) == "E0754");
}

} // namespace abbe::test

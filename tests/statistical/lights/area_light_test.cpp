// Area lights over real shapes: irradiance against closed forms, and every sample against a traced ray.
#include "geometry/embree_scene_builder.h"
#include "geometry/flat_shapes.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "lights/area_light.h"
#include "spectrum/curve.h"
#include "support/statistics.h"
#include "support/whole_emitter.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

constexpr int kSamples = 500000;
const ConstantCurve kUnit(1);
const Wavelengths kAt = Wavelengths::single(550);

// Irradiance at a point facing n, by sampling the light.
test::Moments irradiance(const Light& light, Vec3 from, Vec3 n, std::uint64_t seed) {
    test::Moments result;
    test::Random random(seed);
    for (int i = 0; i < kSamples; ++i) {
        const auto s = light.sample(from, 0, {random.uniform(), random.uniform()}, kAt, 0);
        result.add(s ? s->radiance[0] * std::max(0.f, dot(n, s->wi)) / s->pdfSolidAngle : 0);
    }
    return result;
}

// Lambert's formula for a polygon above the horizon that shows its emitting side, radiance 1.
double polygonIrradiance(const std::vector<Vec3d>& corners, Vec3d from, Vec3d n) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = normalize(corners[i] - from), b = normalize(corners[(i + 1) % corners.size()] - from);
        const Vec3d c = cross(a, b);
        sum += std::atan2(length(c), dot(a, b)) * dot(normalize(c), n);
    }
    return std::abs(sum) / 2;
}

void agrees(const test::Moments& m, double expected) {
    CAPTURE(m.mean());
    CAPTURE(expected);
    CAPTURE(m.standardError());
    CHECK(test::meanTest(m, expected) > 1e-4);
    // A factor of 1.01 would be seen.
    CHECK(m.standardError() < 0.0025 * std::max(expected, 1e-9));
}

TEST_CASE("irradiance under a quad") {
    const Quad quad({-1, 2, -1}, {2, 2, -1}, {2, 2, 1}, {-1, 2, 1}); // counter-clockwise seen from below
    const AreaLight light(quad, {&kUnit, 3}, false);
    const std::vector<Vec3d> corners = {{-1, 2, -1}, {2, 2, -1}, {2, 2, 1}, {-1, 2, 1}};
    std::uint64_t seed = 10;
    for (const Vec3 from : {Vec3{0, 0, 0}, {-1, 0, -1}, {0.3f, 1.8f, 0.2f}, {5, 0, 3}, {60, -80, 10}})
        for (const Vec3 n : {Vec3{0, 1, 0}, normalize(Vec3{0.1f, 1, -0.05f})})
            agrees(irradiance(light, from, n, ++seed), 3 * polygonIrradiance(corners, Vec3d(from), Vec3d(n)));
    // The textbook's form factor of the point below a corner.
    const double x = 1.5, y = 1, rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
    const double corner = (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / 2;
    agrees(irradiance(light, {-1, 0, -1}, {0, 1, 0}, 99), 3 * corner);
}

TEST_CASE("irradiance of a quad that is no rectangle") {
    const Quad quad({0, 2, 0}, {2, 2, 0.5f}, {1.5f, 2, 2}, {-0.5f, 2, 1});
    const AreaLight light(quad, {&kUnit, 1}, false);
    agrees(irradiance(light, {0.5f, 0, 0.5f}, {0, 1, 0}, 3),
           polygonIrradiance({{0, 2, 0}, {2, 2, 0.5}, {1.5, 2, 2}, {-0.5, 2, 1}}, {0.5, 0, 0.5}, {0, 1, 0}));
}

TEST_CASE("irradiance of a sphere: π L sin² θ cos θr") {
    const Sphere sphere({0, 5, 0}, 1);
    const AreaLight light(sphere, {&kUnit, 2}, false);
    std::uint64_t seed = 30;
    for (const float y : {0.f, 3.f, 3.99f, -500.f})
        for (const float tilt : {0.f, 0.05f}) {
            const Vec3 n{std::sin(tilt), std::cos(tilt), 0};
            const double s = 1 / (5.0 - y);
            agrees(irradiance(light, {0, y, 0}, n, ++seed), 2 * kPiD * s * s * std::cos(tilt));
        }
}

TEST_CASE("irradiance of a disk on its axis: π L sin² θ") {
    const Disk disk({1, 4, 0}, {0, -1, 0}, 2);
    const AreaLight light(disk, {&kUnit, 1}, false);
    std::uint64_t seed = 50;
    for (const float y : {0.f, 3.f, -40.f}) {
        const double h = 4 - y;
        agrees(irradiance(light, {1, y, 0}, {0, 1, 0}, ++seed), kPiD * 4 / (4 + h * h));
    }
}

MeshData cube() {
    MeshData data;
    for (int i = 0; i < 8; ++i) data.positions.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
    data.quads = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    return data;
}

TEST_CASE("irradiance of a mesh: a cube that shows two faces") {
    const Mesh cubeMesh(cube());
    const test::WholeEmitter mesh(cubeMesh);
    const AreaLight light(mesh, {&kUnit, 1}, false);
    CHECK(light.power() == doctest::Approx(kPiD * 24 * 470).epsilon(1e-5));
    const Vec3d from{4, 3, 0}, n = normalize(Vec3d{-4, -3, 0});
    const double right = polygonIrradiance({{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}, from, n);
    const double top = polygonIrradiance({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, from, n);
    agrees(irradiance(light, Vec3(from), Vec3(n), 70), right + top);
}

TEST_CASE("inside a sphere that emits inwards the irradiance is π L everywhere") {
    const Sphere sphere({0, 0, 0}, 2);
    const AreaLight light(sphere, {&kUnit, 1}, true);
    std::uint64_t seed = 80;
    for (const Vec3 from : {Vec3{}, {1, 0, 0}, {0, -1.5f, 0.5f}}) {
        const test::Moments m = irradiance(light, from, normalize(Vec3{1, 2, 3}), ++seed);
        CHECK(test::meanTest(m, kPiD) > 1e-4);
        CHECK(m.standardError() < 0.02);
    }
    const AreaLight outward(sphere, {&kUnit, 1}, false);
    CHECK_FALSE(outward.sample(Vec3(), 0, {0.3f, 0.7f}, kAt, 0).has_value());
}

// Traces what was sampled: the ray is free up to the sample, then meets the light where emitted() and pdfSolidAngle()
// tell the same.
void checkAgainstRays(const Shape& shape, bool twoSided, const std::vector<Vec3>& places) {
    const AreaLight light(shape, {&kUnit, 5}, twoSided);
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {nullptr, &light});
    const auto scene = builder.build();
    test::Random random(4);
    int sampled = 0, missed = 0, shadowed = 0, different = 0;
    for (const Vec3 from : places)
        for (int i = 0; i < 2000; ++i) {
            const auto s = light.sample(from, 0, {random.uniform(), random.uniform()}, kAt, 0);
            if (!s) continue;
            ++sampled;
            CHECK(s->pdfSolidAngle > 0);
            CHECK(s->radiance[0] == 5);
            CHECK(length(s->wi) == doctest::Approx(1).epsilon(1e-5));
            const Vec3 toSample = s->p - from;
            CHECK(length(toSample) == doctest::Approx(s->distance).epsilon(1e-5));
            const float reach = length(toSample);
            shadowed += scene->occluded({from, toSample / reach, reach});
            SurfaceHit hit;
            if (!scene->intersect({from, s->wi}, hit)) {
                ++missed; // rounded past the edge
                continue;
            }
            CHECK(hit.light == &light);
            CHECK(light.emitted(hit, -s->wi, kAt)[0] == 5);
            different += std::abs(light.pdfSolidAngle(from, hit, 0) / s->pdfSolidAngle - 1) > 1e-3f;
        }
    CHECK(sampled > 1000);
    CHECK(missed <= sampled / 1000);
    CHECK(shadowed == 0);
    CHECK(different <= sampled / 200);
}

TEST_CASE("samples are what rays meet") {
    const Quad quad({-1, 2, -1}, {2, 2, -1}, {2, 2, 1}, {-1, 2, 1});
    const Sphere sphere({0, 2, 0}, 0.5);
    const Disk disk({0, 2, 0}, {0.2, -1, 0.1}, 0.7);
    const Mesh cubeMesh(cube());
    const test::WholeEmitter mesh(cubeMesh);
    const std::vector<Vec3> places = {{0, -3, 0},  {5, -2, 3},    {0.1f, -1.5f, 0.2f},
                                      {-3, 10, 1}, {100, 3, -80}, {3e4f, -6e4f, 2e4f}};
    for (const Shape* shape : {static_cast<const Shape*>(&quad), static_cast<const Shape*>(&sphere),
                               static_cast<const Shape*>(&disk), static_cast<const Shape*>(&mesh)}) {
        checkAgainstRays(*shape, false, places);
    }
    checkAgainstRays(quad, true, places);
    checkAgainstRays(disk, true, places);
}

// Hard case 32.
TEST_CASE("on, behind, inside and at the corners of a light everything is finite") {
    const Quad quad({-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1});
    const Sphere sphere({0, 0, 0}, 1);
    const Disk disk({0, 0, 0}, {0, -1, 0}, 1);
    const Mesh cubeMesh(cube());
    const test::WholeEmitter mesh(cubeMesh);
    std::vector<Vec3> places = {{0, 1e-20f, 0},      {0, -1e-7f, 0},     {1, -1e-6f, 1},    {1e-30f, 1, 0},
                                {0, 0.99999994f, 0}, {0, 1.0000001f, 0}, {1e15f, 1e15f, 0}, {2, 0, 0}};
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y)
            for (int z = -2; z <= 2; ++z)
                places.push_back({static_cast<float>(x) / 2, static_cast<float>(y) / 2, static_cast<float>(z) / 2});
    test::Random random(5);
    for (const Shape* shape : {static_cast<const Shape*>(&quad), static_cast<const Shape*>(&sphere),
                               static_cast<const Shape*>(&disk), static_cast<const Shape*>(&mesh)})
        for (const bool twoSided : {false, true}) {
            const AreaLight light(*shape, {&kUnit, 1}, twoSided);
            for (const Vec3 from : places)
                for (int i = 0; i < 50; ++i) {
                    const auto corner = [&](int bit) { return i & bit ? kOneMinusEpsilon : 0.f; };
                    const Vec2 u = i < 4 ? Vec2{corner(1), corner(2)} : Vec2{random.uniform(), random.uniform()};
                    const auto s = light.sample(from, 0, u, kAt, 0);
                    if (!s) continue;
                    CHECK(isFinite(s->wi));
                    CHECK(isFinite(s->p));
                    CHECK(s->pdfSolidAngle > 0);
                    CHECK(isFinite(s->pdfSolidAngle));
                    CHECK(isFinite(s->distance));
                }
        }
}

TEST_CASE("power counts the sides that emit; planes have none") {
    const Disk disk({0, 0, 0}, {0, 0, 1}, 2);
    CHECK(AreaLight(disk, {&kUnit, 2}, false).power() == doctest::Approx(kPiD * 4 * kPiD * 940));
    CHECK(AreaLight(disk, {&kUnit, 2}, true).power() == doctest::Approx(kPiD * 4 * kPiD * 1880));
    const Plane plane({0, 0, 0}, {0, 1, 0});
    const AreaLight light(plane, {&kUnit, 1}, false);
    CHECK(light.power() == 0);
    CHECK_FALSE(light.sample(Vec3{0, 1, 0}, 0, {0.5f, 0.5f}, kAt, 0).has_value());
}

} // namespace
} // namespace abbe

// Meshes, curves and points that deform while the shutter is open: at every time they are the shape that stands still
// where they are then.
#include "geometry/curves.h"
#include "geometry/deforming_mesh.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "geometry/points.h"
#include "geometry/subdivision_surface.h"
#include "math/warp.h"
#include "support/nightly.h"
#include "support/statistics.h"
#include "support/subdivision_cages.h"
#include "unit/geometry/test_meshes.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::test;

namespace {

// Between the steps around a time, in double.
template <typename F> auto at(double time, std::size_t steps, F state) {
    const double scaled = time * static_cast<double>(steps - 1);
    const auto step = std::min(static_cast<std::size_t>(scaled), steps - 2);
    const double f = scaled - static_cast<double>(step);
    return state(step) * (1 - f) + state(step + 1) * f;
}

std::unique_ptr<Intersector> sceneOf(const Shape& shape) {
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {});
    return builder.build();
}

Vec3 anyDirection(Random& random) { return squareToSphere({random.uniform(), random.uniform()}); }

struct Comparison {
    int hits = 0, differing = 0, outside = 0;
    double worst = 0, worstNormal = 0, worstOff = 0; // the last: distance from the still surface in its error bounds
};

// Rays at random times against the shape as it stands at each. `still` makes it; `of` intersects the deforming one.
template <typename Still> Comparison compare(const Intersector& of, Still still, int times, int rays, float reach = 3) {
    Random random(3);
    Comparison c;
    const Bounds3 box = of.bounds();
    const Vec3 middle = (box.lower + box.upper) * 0.5f, half = (box.upper - box.lower) * 0.5f;
    for (int t = 0; t < times; ++t) {
        const float time = t == 0 ? 0.f : t == 1 ? 1.f : random.uniform();
        const std::unique_ptr<const Shape> shape = still(static_cast<double>(time));
        const auto expected = sceneOf(*shape);
        for (int i = 0; i < rays; ++i) {
            const Vec3 target = middle + Vec3(half.x * (2 * random.uniform() - 1), half.y * (2 * random.uniform() - 1),
                                              half.z * (2 * random.uniform() - 1));
            const Vec3 d = anyDirection(random);
            const Ray ray{target - d * reach * length(half), d, kInfinity, time};
            SurfaceHit a, b;
            const bool ma = of.intersect(ray, a), mb = expected->intersect(ray, b);
            c.differing += ma != mb || of.occluded(ray) != mb;
            if (!ma || !mb) continue;
            if (length(a.p - b.p) > 0.05f * length(half)) { // past an edge, to what is behind
                ++c.differing;
                continue;
            }
            ++c.hits;
            c.outside += maxComponent(max(box.lower - a.p - a.pError, a.p - box.upper - a.pError)) > 0;
            c.worst = std::max(c.worst, static_cast<double>(length(a.p - b.p)));
            c.worstNormal = std::max({c.worstNormal, static_cast<double>(length(a.ng - b.ng)),
                                      static_cast<double>(length(a.shading.z - b.shading.z))});
            c.worstOff = std::max(c.worstOff, static_cast<double>(std::abs(dot(a.p - b.p, b.ng))) /
                                                  static_cast<double>(dot(a.pError + b.pError, abs(b.ng))));
        }
    }
    return c;
}

void check(const Comparison& c, int leastHits, double tolerance, double normalTolerance = 2e-3) {
    CHECK(c.hits > leastHits);
    CHECK(c.differing <= 5); // a ray along an edge may fall to either side
    CHECK(c.outside == 0);
    CHECK(c.worst < tolerance);
    CHECK(c.worstNormal < normalTolerance);
    CHECK(c.worstOff < 1.5);
}

// The unit square in the plane z = 0.
MeshData squareMesh(bool quad) {
    MeshData m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    if (quad)
        m.quads = {{0, 1, 2, 3}};
    else
        m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
}

// A ball that is squashed, leans and grows in three steps, with normals.
MeshData ball(int step) {
    MeshData m = icosphere(3, {}, 1);
    const Vec3d scale[] = {{1, 1, 1}, {1.4, 0.5, 1.2}, {0.8, 1.7, 0.9}};
    const Vec3d offset[] = {{0, 0, 0}, {0.5, 1, 0}, {2, 0.3, -0.5}};
    for (Vec3& p : m.positions) {
        const Vec3d q(p);
        p = Vec3(Vec3d{q.x * scale[step].x + 0.3 * step * q.y, q.y * scale[step].y, q.z * scale[step].z} +
                 offset[step]);
        m.normals.push_back(normalize(Vec3(Vec3d{(1 + step) * q.x, q.y, q.z}))); // which turn
    }
    return m;
}

MeshStep stepOf(const MeshData& m) { return {m.positions, m.normals}; }
DeformingMesh deforming(const std::vector<MeshData>& keys) {
    std::vector<MeshStep> steps;
    for (const MeshData& k : keys) steps.push_back(stepOf(k));
    return {keys[0], std::move(steps)};
}

// As the deforming mesh is at a time.
std::unique_ptr<const Shape> frozen(const std::vector<MeshData>& keys, double time) {
    MeshData m = keys[0];
    for (std::size_t i = 0; i < m.positions.size(); ++i)
        m.positions[i] = Vec3(at(time, keys.size(), [&](std::size_t k) { return Vec3d(keys[k].positions[i]); }));
    for (std::size_t i = 0; i < m.normals.size(); ++i)
        m.normals[i] = Vec3(at(time, keys.size(), [&](std::size_t k) { return Vec3d(keys[k].normals[i]); }));
    return std::make_unique<const Mesh>(std::move(m));
}

} // namespace

TEST_CASE("deformation: a square that rises, tilts and grows is met where the formula says") {
    for (const bool quad : {false, true}) {
        const MeshData begin = squareMesh(quad);
        MeshData end = begin;
        // Corner (x, y) goes to (2x, y, 3 + x): at time t the surface is z = 3 t + x t / (1 + t).
        for (Vec3& p : end.positions) p = {2 * p.x, p.y, 3 + p.x};
        const DeformingMesh mesh = deforming({begin, end});
        const auto scene = sceneOf(mesh);
        Random random(1);
        for (int i = 0; i < 20000; ++i) {
            const float t = i == 0 ? 0.f : i == 1 ? 1.f : random.uniform();
            const double td = static_cast<double>(t);
            const Vec3 origin(2 * random.uniform() - 0.2f, 1.4f * random.uniform() - 0.2f, 9);
            const double u = static_cast<double>(origin.x) / (1 + td), v = static_cast<double>(origin.y);
            const double margin = std::min({std::abs(u), std::abs(1 - u), std::abs(v), std::abs(1 - v)});
            if (margin < 1e-5) continue;
            SurfaceHit hit;
            const bool met = scene->intersect({origin, {0, 0, -1}, kInfinity, t}, hit);
            REQUIRE(met == (u > 0 && u < 1 && v > 0 && v < 1));
            CHECK(scene->occluded({origin, {0, 0, -1}, kInfinity, t}) == met);
            if (!met) continue;
            const double z = 3 * td + u * td; // at x = u (1 + t)
            REQUIRE(length(Vec3d(hit.p) - Vec3d{static_cast<double>(origin.x), v, z}) < 2e-6);
            REQUIRE(std::abs(static_cast<double>(hit.distance) - (9 - z)) < 2e-5);
            const Vec3d n = normalize(Vec3d{-td / (1 + td), 0, 1});
            REQUIRE(length(Vec3d(hit.ng) - n) < 1e-6);
        }
        CHECK(mesh.bounds().lower == Vec3(0, 0, 0));
        CHECK(mesh.bounds().upper == Vec3(2, 1, 4));
    }
}

TEST_CASE("deformation: points go along, whether or not faces have materials of their own") {
    const MeshData begin = squareMesh(true);
    MeshData end = begin;
    for (Vec3& p : end.positions) p.x += 1;
    const DeformingMesh plain = deforming({begin, end});
    const FaceMaterials dressed(std::make_unique<const DeformingMesh>(deforming({begin, end})), {nullptr}, {0});
    for (const Shape* shape : {static_cast<const Shape*>(&plain), static_cast<const Shape*>(&dressed)}) {
        const auto scene = sceneOf(*shape);
        const Ray ray{{1, 0.5f, 9}, {0, 0, -1}, kInfinity, 0.5f};
        SurfaceHit hit;
        REQUIRE(scene->intersect(ray, hit));
        const auto passage = scene->passage(ray, hit, hit.distance);
        REQUIRE(passage);
        CHECK(length(passage->opening - Vec3(0.5f, 0.5f, 0)) < 1e-5f);
        CHECK(length(passage->closing - Vec3(1.5f, 0.5f, 0)) < 1e-5f);
    }
}

TEST_CASE("deformation: a mesh in three steps is at every time the mesh that stands there" *
          doctest::test_suite("input")) {
    const std::vector<MeshData> keys{ball(0), ball(1), ball(2)};
    const DeformingMesh mesh = deforming(keys);
    const auto scene = sceneOf(mesh);
    check(compare(
              *scene, [&](double t) { return frozen(keys, t); }, 60, 600),
          10'000, 2e-5);
}

TEST_CASE("deformation: inside of objects in objects, still and moving") {
    const std::vector<MeshData> keys{ball(0), ball(2), ball(1)};
    const DeformingMesh mesh = deforming(keys);
    const Transform inner = Transform::scale({-1, 1, 2}).then(Transform::translate({0, 3, 0}));
    const Transform outer = Transform::rotate({0, 0, 1}, 0.5).then(Transform::translate({1, 0, 0}));
    EmbreeSceneBuilder builder;
    const std::uint32_t low = builder.addObject({{&mesh, {}}}), high = builder.addObject({});
    builder.addInstance(low, inner, high);
    builder.addInstance(high, outer);
    const auto scene = builder.build();
    const auto still = [&](double t) {
        const auto shape = frozen(keys, t);
        MeshData m = static_cast<const Mesh&>(*shape).data();
        const Transform map = inner.then(outer);
        for (Vec3& p : m.positions) p = Vec3(map.point(Vec3d(p)));
        for (Vec3& n : m.normals) n = Vec3(normalize(map.normal(Vec3d(n))));
        for (auto& tri : m.triangles) std::swap(tri[1], tri[2]); // mirrored
        return std::unique_ptr<const Shape>(std::make_unique<const Mesh>(std::move(m)));
    };
    check(compare(*scene, still, 40, 600), 5'000, 1e-4, 6e-2); // an instance interpolates normals before it scales them

    // The same object on the move: what happens inside and outside is at the same time.
    EmbreeSceneBuilder moving;
    moving.setShutter(0, 1);
    const std::uint32_t object = moving.addObject({{&mesh, {}}});
    const KeyedTransform path({{0, {}}, {1, {{TransformStep::Kind::translate, {0, 4, 0}, 0, {}}}}});
    moving.addMoving(object, Motion().then(path));
    const auto movingScene = moving.build();
    const auto stillMoved = [&](double t) {
        const auto shape = frozen(keys, t);
        return std::unique_ptr<const Shape>(std::make_unique<const Mesh>(
            moved(static_cast<const Mesh&>(*shape).data(), Transform::translate({0, 4 * t, 0}))));
    };
    check(compare(*movingScene, stillMoved, 40, 600), 3'000, 1e-4);
}

TEST_CASE("deformation: closed surfaces let no ray out at any time") {
    // Two cages of the same faces, diced by the plan of one of them.
    const std::size_t rays = test::nightly() ? 1'000'000 : 50'000;
    for (const auto& [name, cage, closed] : namedCages()) {
        if (!closed) continue;
        CAPTURE(name);
        const SubdivisionSurface surface(cage);
        const DicingPlan plan = surface.plan({Dicing::Mode::length, 0.1, {}}, 1ull << 32);
        std::vector<MeshData> keys;
        for (const Vec3d scale : {Vec3d{1, 1, 1}, Vec3d{1.3, 0.6, 1.1}, Vec3d{0.7, 1.5, 1.2}}) {
            std::vector<Vec3> points = cage.positions;
            for (Vec3& p : points) p = Vec3(Transform::scale(scale).point(Vec3d(p)));
            keys.push_back(surface.dice(plan, points).mesh);
        }
        const DeformingMesh mesh = deforming(keys);
        const auto scene = sceneOf(mesh);
        Vec3d sum;
        for (const Vec3 p : keys[0].positions) sum += Vec3d(p);
        const Vec3 inside(sum / static_cast<double>(keys[0].positions.size()));
        Random random(8);
        std::size_t escaped = 0;
        for (std::size_t i = 0; i < rays; ++i) {
            SurfaceHit hit;
            const Ray ray{inside, anyDirection(random), kInfinity, random.uniform()};
            escaped += !scene->intersect(ray, hit) || !scene->occluded(ray);
        }
        CHECK(escaped == 0);
    }
}

TEST_CASE("deformation: a ray that leaves the surface does not meet it again where it left") {
    const std::vector<MeshData> keys{ball(0), ball(1), ball(2)};
    const DeformingMesh mesh = deforming(keys);
    const auto scene = sceneOf(mesh);
    Random random(4);
    int left = 0, again = 0;
    for (int i = 0; i < 20000; ++i) {
        const float time = random.uniform();
        const Vec3 d = anyDirection(random);
        SurfaceHit hit;
        if (!scene->intersect({Vec3(0.8f, 0.5f, 0) - d * 6, d, kInfinity, time}, hit)) continue;
        Vec3 out = anyDirection(random);
        if (dot(out, hit.ng) < 0) out = -out; // the ball is convex
        if (dot(out, hit.ng) < 1e-3f) continue;
        ++left;
        again += scene->occluded({spawnOrigin(hit, out), out, kInfinity, time});
    }
    CHECK(left > 5000);
    CHECK(again == 0);
}

TEST_CASE("deformation: triangles met edge-on are decided where they are at that time") {
    // A needle of long thin triangles that moves sideways by many times its width.
    MeshData begin;
    for (int i = 0; i < 40; ++i) {
        const float x = static_cast<float>(i);
        begin.positions.insert(begin.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1e-4f, 1000}});
        const auto v = static_cast<std::uint32_t>(3 * i);
        begin.triangles.push_back({v, v + 1, v + 2});
    }
    MeshData end = begin;
    for (Vec3& p : end.positions) p = p + Vec3(0, 7, 0);
    const DeformingMesh mesh = deforming({begin, end});
    const auto scene = sceneOf(mesh);
    Random random(6);
    const Mesh still(begin);
    const auto stillScene = sceneOf(still);
    int met = 0, wrong = 0, differing = 0;
    for (int i = 0; i < 100'000; ++i) {
        const float time = random.uniform();
        const Vec3 target(40 * random.uniform(), 7 * time, 900 * random.uniform());
        const Vec3 d = normalize(Vec3(2 * random.uniform() - 1, 1e-5f * (2 * random.uniform() - 1), 1));
        SurfaceHit hit, there;
        const Vec3 origin = target - d * 2000;
        const bool meets = scene->intersect({origin, d, kInfinity, time}, hit);
        differing += meets != stillScene->intersect({origin - Vec3(0, 7 * time, 0), d}, there);
        if (!meets) continue;
        ++met;
        wrong += std::abs(hit.p.y - 7 * time) > 0.01f;
    }
    INFO(differing << " of " << met);
    CHECK(met > 1000);
    CHECK(wrong == 0);
    CHECK(differing < met / 20); // along edges, by rounding of the places
}

TEST_CASE("deformation: curves bend and change their width") {
    for (const CurveBasis basis : {CurveBasis::linear, CurveBasis::bspline, CurveBasis::catmullRom, CurveBasis::bezier})
        for (const CurveForm form : {CurveForm::round, CurveForm::flat}) {
            CAPTURE(int(basis));
            CAPTURE(int(form));
            const std::vector<std::vector<SizedPoint>> keys{
                {{{0, 0, 0}, 0.1f}, {{0, 1, 0}, 0.1f}, {{0, 2, 0}, 0.1f}, {{0, 3, 0}, 0.1f}},
                {{{0, 0, 0}, 0.3f}, {{1, 1, 0}, 0.2f}, {{1.5f, 2, 1}, 0.1f}, {{1, 3, 1}, 0.2f}},
                {{{1, 0, 0}, 0.1f}, {{1, 1, 1}, 0.3f}, {{1, 2, 0}, 0.3f}, {{0, 3, 1}, 0.1f}}};
            const Curves curves(CurveData{basis, form, keys[0], {4}, {keys[1], keys[2]}});
            const auto still = [&](double t) {
                std::vector<SizedPoint> points(4);
                for (std::size_t i = 0; i < 4; ++i) {
                    points[i].position = Vec3(at(t, 3, [&](std::size_t k) { return Vec3d(keys[k][i].position); }));
                    points[i].radius = static_cast<float>(
                        at(t, 3, [&](std::size_t k) { return static_cast<double>(keys[k][i].radius); }));
                }
                return std::unique_ptr<const Shape>(
                    std::make_unique<const Curves>(CurveData{basis, form, points, {4}}));
            };
            const auto scene = sceneOf(curves);
            const Comparison c = compare(*scene, still, 40, 1000);
            CHECK(c.hits > 1'500);
            CHECK(c.differing <= c.hits / 200); // Embree's iteration, at silhouettes
            CHECK(c.outside == 0);
            CHECK(c.worst < 6e-3); // rays that graze
            CHECK(c.worstOff < 3);
        }
}

TEST_CASE("deformation: points move, grow and turn" * doctest::test_suite("input")) {
    for (const PointForm form : {PointForm::sphere, PointForm::disk, PointForm::orientedDisk}) {
        CAPTURE(int(form));
        Random random(2);
        std::vector<PointData::Step> keys(3);
        for (auto& key : keys)
            for (int i = 0; i < 30; ++i) {
                const Vec3 p(random.uniform(), random.uniform(), random.uniform());
                key.points.push_back({p * 2.f, i == 0 && &key == &keys[0] ? 0.f : 0.05f + 0.1f * random.uniform()});
                if (form == PointForm::orientedDisk) key.normals.push_back(normalize(p + Vec3(0.1f, 0.1f, 0.1f)));
            }
        const Points points(PointData{form, keys[0].points, keys[0].normals, {keys[1], keys[2]}});
        CHECK(points.count() == 30); // that of radius 0 at first grows
        CHECK(points.omitted() == 0);
        const auto still = [&](double t) {
            PointData data{form, keys[0].points, keys[0].normals};
            for (std::size_t i = 0; i < data.points.size(); ++i) {
                data.points[i].position =
                    Vec3(at(t, 3, [&](std::size_t k) { return Vec3d(keys[k].points[i].position); }));
                data.points[i].radius = static_cast<float>(
                    at(t, 3, [&](std::size_t k) { return static_cast<double>(keys[k].points[i].radius); }));
                if (!data.normals.empty())
                    data.normals[i] =
                        Vec3(normalize(at(t, 3, [&](std::size_t k) { return Vec3d(keys[k].normals[i]); })));
            }
            return std::unique_ptr<const Shape>(std::make_unique<const Points>(std::move(data)));
        };
        const auto scene = sceneOf(points);
        const Comparison c = compare(*scene, still, 40, 1000);
        CHECK(c.hits > 3'000);
        CHECK(c.differing <= 5);
        CHECK(c.outside == 0);
        CHECK(c.worst < 2e-3);
        CHECK(c.worstOff < 3);
    }
}

TEST_CASE("deformation: memory is counted") {
    const DeformingMesh mesh = deforming({ball(0), ball(1), ball(2)});
    const std::size_t vertices = ball(0).positions.size(), triangles = ball(0).triangles.size();
    CHECK(mesh.bytes() == triangles * 12 + 3 * vertices * 24);
    const std::vector<SizedPoint> strand{{{0, 0, 0}, 1}, {{0, 1, 0}, 1}};
    const Curves still(CurveData{CurveBasis::linear, CurveForm::round, strand, {2}});
    const Curves moving(CurveData{CurveBasis::linear, CurveForm::round, strand, {2}, {strand, strand}});
    CHECK(moving.bytes() == still.bytes() + 2 * 2 * sizeof(SizedPoint));
}

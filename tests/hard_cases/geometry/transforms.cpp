// Maps that mirror, flatten, pile up and move: cases 17 to 21 of docs/hard_cases.md.
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "hard_cases/hard_case.h"
#include "math/motion.h"
#include "support/scene_test.h"
#include "unit/geometry/test_meshes.h"

using namespace abbe;
using namespace abbe::test;

namespace {

Transform mixed(const Transform& a, const Transform& b, double u) {
    Transform m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m.a[i][j] = a.a[i][j] * (1 - u) + b.a[i][j] * u;
    return m;
}

} // namespace

TEST_CASE("case 17: mirrored and sheared instances") {
    HardCase c;
    Transform shear;
    shear.a[0][1] = 0.4;
    const Transform map = Transform::rotate({1, 2, 3}, 0.7)
                              .then(Transform::scale({1.5, 0.6, -1.2}))
                              .then(shear)
                              .then(Transform::translate({0.3, -0.2, 0.5}));
    MeshData data = icosphere(3, {}, 1);
    data.normals = data.positions;
    const Mesh mesh(data), baked(moved(data, map), true);
    EmbreeSceneBuilder placed, plain;
    placed.addInstance(placed.addObject({{&mesh, {}}}), map);
    plain.addShape(baked, {});
    const auto a = placed.build(), b = plain.build();
    Random random(4);
    double worst = 0, naive = 0;
    int met = 0;
    for (int i = 0; i < 50000; ++i) {
        const Vec3 o = normalize(Vec3(random.uniform() - 0.5f, random.uniform() - 0.5f, random.uniform() - 0.5f)) * 9.f;
        const Vec3 target(random.uniform() - 0.2f, random.uniform() - 0.7f, random.uniform());
        SurfaceHit ha, hb;
        const Vec3 d = normalize(target - o);
        if (!a->intersect({o, d}, ha) || !b->intersect({o, d}, hb) || length(ha.p - hb.p) > 1e-4f) continue;
        if (ha.primitive != hb.primitive) continue; // at an edge
        ++met;
        worst =
            std::max(worst, static_cast<double>(std::max(length(ha.ng - hb.ng), length(ha.shading.z - hb.shading.z))));
        const Vec3d n = normalize(map.vector(normalize(Vec3d(map.inverse()->normal(Vec3d(hb.ng))))));
        naive = std::max(naive, length(n - Vec3d(hb.ng)));
    }
    CHECK(met > 10000);
    c.measured("largest difference of a normal from the baked mesh's", worst, 1e-3);
    c.naive("normals mapped as directions are", naive);
}

TEST_CASE("case 18: transforms of almost no volume") {
    HardCase c;
    int wrong = 0;
    for (const Vec3d s : {Vec3d(0, 1, 1), Vec3d(0, 0, 0), Vec3d(1e-40, 1, 1), Vec3d(1, 1e-31, 1)})
        wrong += Transform::scale(s).inverse().has_value();
    for (const Vec3d s : {Vec3d(1e-20, 1e-20, 1e-20), Vec3d(1e9, 1e9, 1e9), Vec3d(1e-6, 1, 1e6)})
        wrong += !Transform::scale(s).inverse(); // small or stretched, but not singular
    Transform flat;                              // two equal rows
    flat.a[1][0] = 1;
    flat.a[1][1] = 0;
    wrong += flat.inverse().has_value();
    Transform bad;
    bad.a[2][2] = std::numeric_limits<double>::quiet_NaN();
    wrong += bad.inverse().has_value();
    for (const char* scale : {"0", "1 0 1", "1e-40 1 1"}) {
        const TestScene scene = TestScene::parse(std::string("scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\n"
                                                             "light sky { radiance 1 }\nobject ball { shape sphere }\n"
                                                             "instance ball { transform { scale ") +
                                                 scale + " } }\n");
        wrong += !scene.diagnostics().hasErrors();
    }
    c.measured("of twelve maps, those that are judged wrongly", wrong, 0);
    const float s = 1e-20f; // by single precision: the small map, which is not singular, has a determinant of 0
    c.naive("inverse of a scale of 1e-20 by the determinant in single precision",
            static_cast<double>(s * s / (s * s * s)));
}

// The hit of the innermost sphere through sixteen levels that are traversed one after another.
TEST_CASE("case 19: long chains of transforms") {
    HardCase c;
    const Mesh mesh(icosphere(3, {}, 1));
    EmbreeSceneBuilder builder, plain;
    std::uint32_t object = builder.addObject({{&mesh, {}}});
    Transform chain;
    std::vector<Transform> steps;
    for (int i = 0; i < 16; ++i) {
        const Transform step =
            Placement(Transform::translate({0.1 * i, 0.2, -0.1}).then(Transform::rotate({1.0 + i, 2, 3}, 0.3 * i)))
                .map();
        const std::uint32_t outer = i < 15 ? builder.addObject({}) : EmbreeSceneBuilder::kScene;
        builder.addInstance(object, step, outer);
        chain = chain.then(step);
        steps.push_back(step);
        object = outer;
    }
    plain.addShape(mesh, {});
    const auto a = builder.build(), b = plain.build();
    Random random(1);
    double worst = 0, naive = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d o(random.uniformDouble() - 0.5, random.uniformDouble() - 0.5, 4);
        SurfaceHit ha, hb;
        REQUIRE(b->intersect({Vec3(o), {0, 0, -1}}, hb));
        const Vec3d exact = chain.point(Vec3d(hb.p));
        REQUIRE(a->intersect({Vec3(chain.point(o)), Vec3(chain.vector({0, 0, -1}))}, ha));
        worst = std::max(worst, length(Vec3d(ha.p) - exact));
        // A kilometre between two levels, rounded at each.
        Vec3 p = hb.p + Vec3(1000, 0, 0);
        for (const Transform& step : steps) p = Vec3(step.point(Vec3d(p)));
        naive = std::max(naive, length(Vec3d(p) - chain.point(Vec3d(hb.p) + Vec3d(1000, 0, 0))));
    }
    c.measured("largest error of a hit after sixteen levels, over the size of the object", worst / 2, 1e-5);
    c.naive("points 1 km away rounded to float at each level", naive / 2);
}

TEST_CASE("case 20: rotation between two times") {
    HardCase c;
    const Transform whole = Transform::rotate({0, 0, 1}, 170 * kPiD / 180);
    const Decomposition a = Decomposition::of({}), b = Decomposition::of(whole);
    double worst = 0, naive = 0;
    for (int i = 0; i <= 100; ++i) {
        const double u = i / 100.0;
        worst = std::max(worst, std::abs(length(interpolate(a, b, u).compose().point({1, 0, 0})) - 1));
        naive = std::max(naive, std::abs(length(mixed({}, whole, u).point({1, 0, 0})) - 1));
    }
    // The tip of a rendered blade of length 1: it is met just inside and not just outside of its circle.
    const TestScene scene = TestScene::parse(
        "scene 1\ncamera { from 0 0 5; look-at 0 0 0; shutter 1 s }\nlight sky { radiance 1 }\n"
        "shape quad { points 0 -0.02 0  1 -0.02 0  1 0.02 0  0 0.02 0\n"
        "transform { at 0 s { matrix 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1 }\nat 1 s { rotate z 170 deg } } }\n");
    REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    const auto reach = [&](double angle, float time) {
        double inside = 0, outside = 2; // bisection along the radius
        for (int k = 0; k < 40; ++k) {
            const double r = (inside + outside) / 2;
            const Vec3d p = Vec3d(r * std::cos(angle), r * std::sin(angle), 5) - scene.scene().origin;
            SurfaceHit hit;
            const Ray ray{Vec3(p), {0, 0, -1}, kInfinity, time};
            (scene.scene().intersector->intersect(ray, hit) ? inside : outside) = r;
        }
        return inside;
    };
    for (int i = 0; i <= 20; ++i)
        worst = std::max(worst, std::abs(reach(170 * kPiD / 180 * i / 20, static_cast<float>(i) / 20) - 1));
    c.measured("largest error of the length of a blade that turns by 170°, over its length", worst, 1e-4);
    c.naive("matrices mixed entry by entry", naive);
}

TEST_CASE("case 21: a shutter or motion without duration") {
    HardCase c;
    int bad = 0;
    const auto scene = [](const std::string& camera, const std::string& body) {
        return TestScene::parse("scene 1\nfilm { size 8 8 }\ncamera { from 0 0 5; look-at 0 0 0; " + camera +
                                " }\nlight sky { radiance 1 }\n" + body);
    };
    const std::string slide = "transform { at 0 s { translate 0 0 0 }\nat 1 s { translate 1 0 0 } }";
    // No shutter, one that is open for no time, one that opens at the last key.
    for (const char* camera : {"", "shutter 0 s", "time 1 s; shutter 0 s", "shutter 1 s"}) {
        const TestScene s =
            scene(camera, "shape sphere { " + slide + " }\nshape sphere { transform { at 1 s { scale 1 } } }\n");
        if (s.diagnostics().hasErrors()) continue; // an error is an answer
        const TestImage image = render(s, 8);
        bad += image.statistics.dropped != std::array<std::uint64_t, 3>{};
        for (int i = 0; i < 64; ++i) bad += !std::isfinite(image.film.mean(i % 8, i / 8).y);
        bad += !(image.film.mean(4, 4).y > 0);
    }
    // Two keys at one time have no answer between them.
    bad +=
        !scene("shutter 1 s", "shape sphere { transform { at 1 s { translate 0 0 0 }\nat 1 s { translate 1 0 0 } } }\n")
             .diagnostics()
             .hasErrors();
    c.measured("pixels that are not finite, samples dropped and bad keys accepted", bad, 0);
    const volatile float from = 1, to = 1, at = 1;
    c.naive("place between two equal times", static_cast<double>((at - from) / (to - from)));
}

// From definitions to what rays meet: transforms, units, groups, objects and instances, mesh files.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>

namespace abbe::test {
namespace {

// A file that lives as long as the test.
class MeshFileForTest {
  public:
    MeshFileForTest(const std::string& name, const std::string& text)
        : path_(std::filesystem::temp_directory_path() / ("abbe_scene_test_" + name)) {
        std::ofstream(path_) << text;
    }
    ~MeshFileForTest() { std::filesystem::remove(path_); }
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

} // namespace

TEST_CASE("geometry: world positions, whatever the camera") {
    for (const char* from : {"0 0 5", "1000 -20 30", "1e6 1e6 1e6"}) {
        const auto scene = TestScene::parse(fmt::format("scene 1\ncamera {{ from {}; look-at 0 1 0 }}\n", from) + kSky +
                                            "shape sphere { center 2 1 0; radius 0.5 }");
        const Vec3d eye = scene.scene().origin;
        const WorldHit hit = trace(scene, eye, Vec3d{2, 1, 0} - eye);
        REQUIRE(hit.met);
        CHECK(std::abs(length(hit.p - Vec3d{2, 1, 0}) - 0.5) < 1e-6 * length(eye) + 1e-6);
    }
}

TEST_CASE("geometry: bare lengths are the header's unit, others keep theirs") {
    const std::string rest = "camera { from 0 0 5 m; look-at 0 0 0 }\n" + kSky +
                             "shape sphere { center 0 0 0; radius 250 }\n"
                             "shape sphere { center 2 0 0 m; radius 0.25 m }\n";
    const auto scene = TestScene::parse("scene 1 length=mm\n" + rest);
    REQUIRE(scene.report() == "");
    CHECK(near(trace(scene, {0, 0, 5}, {0, 0, -1}).p, {0, 0, 0.25}));
    CHECK(near(trace(scene, {2, 0, 5}, {0, 0, -1}).p, {2, 0, 0.25}));
    CHECK(scene.built().facts.bounds.upper.x == doctest::Approx(2.25));
}

TEST_CASE("geometry: transforms apply from top to bottom, groups from the inside out") {
    const auto scene = build("group { transform { translate 0 0 2 }\n"
                             "  group { transform { rotate z 90 deg; translate 1 0 0 }\n"
                             "    shape sphere { center 1 0 0; radius 0.1; transform { scale 2 } } } }");
    REQUIRE(scene.report() == "");
    // (1 0 0) → scale (2 0 0) → rotate (0 2 0) → translate (1 2 0) → (1 2 2); radius 0.2
    CHECK(near(trace(scene, {1, 2, 9}, {0, 0, -1}).p, {1, 2, 2.2}));
    CHECK_FALSE(trace(scene, {1.25, 2, 9}, {0, 0, -1}).met);
}

TEST_CASE("geometry: where z is up") {
    const auto scene = TestScene::parse("scene 1 up=z\ncamera { from 0 -5 1 }\n" + kSky +
                                        "shape plane\nshape sphere { center 0 0 1; radius 0.5 }");
    REQUIRE(scene.report() == "");
    const CameraRay ray = scene.scene().camera->ray({{640, 360}, {0.5f, 0.5f}, 0});
    CHECK(near(Vec3d(ray.ray.direction), {0, 1, 0}, 1e-6));
    const WorldHit ground = trace(scene, {3, 3, 2}, {0, 0, -1});
    REQUIRE(ground.met);
    CHECK(near(ground.p, {3, 3, 0}));
    CHECK(near(Vec3d(ground.hit.ng), {0, 0, 1}));
}

TEST_CASE("geometry: an instance is the same surface as one made in place") {
    const std::string block =
        "points { - -1 -1 -1; - 1 -1 -1; - 1 1 -1; - -1 1 -1; - -1 -1 1; - 1 -1 1; - 1 1 1; - -1 1 1 }\n"
        "faces { - 3 2 1 0; - 4 5 6 7; - 0 1 5 4; - 1 2 6 5; - 2 3 7 6; - 3 0 4 7 }\n";
    for (const char* place :
         {"translate 1 2 0.5", "rotate y 30 deg; rotate x -20 deg; translate 0 1 0", "scale 2 0.5 1; rotate z 40 deg",
          "scale -1 1 1; translate 0.3 0 0", "scale -1 2 -3; rotate y 50 deg"}) {
        INFO(std::string(place));
        const auto baked = build("shape mesh { " + block + " transform { " + place + " } }");
        const auto instanced = build("object box { shape mesh { " + block + " } }\ninstance box { transform { " +
                                     std::string(place) + " } }");
        REQUIRE(baked.report() == "");
        REQUIRE(instanced.report() == "");
        CHECK(instanced.built().facts.objects == 1);
        CHECK(instanced.built().facts.instances == 1);
        int met = 0;
        for (int i = 0; i < 400; ++i) {
            // Past the edges of the block, where two faces are as near.
            const Vec3d from{-3 + 0.3 * (i % 20) + 0.013, -3 + 0.3 * (i / 20) + 0.01, 9};
            const WorldHit a = trace(baked, from, {0.05, 0.02, -1}), b = trace(instanced, from, {0.05, 0.02, -1});
            REQUIRE(a.met == b.met);
            if (!a.met) continue;
            ++met;
            CHECK_UNARY(near(a.p, b.p, 1e-5));
            CHECK_UNARY(near(Vec3d(a.hit.ng), Vec3d(b.hit.ng), 1e-5));
        }
        CHECK(met > 20);
    }
}

TEST_CASE("geometry: instances of instances, with their emitters and planes") {
    const auto scene = build("object lamp { shape sphere { radius 0.1; emission 3 }\n"
                             "  shape sphere { center 0 0.5 0; radius 0.2 } }\n"
                             "object pair { instance lamp { transform { translate -1 0 0 } }\n"
                             "  instance lamp { transform { translate 1 0 0 } } }\n"
                             "instance pair\ninstance pair { transform { translate 0 5 0 } }");
    REQUIRE(scene.report() == "");
    CHECK(scene.scene().lights.size() == 1 + 4); // the sky, and a light of its own for every light
    CHECK(scene.built().facts.instances == 4);
    CHECK(scene.built().facts.objects == 2);
    for (const Vec3d emitter : {Vec3d{-1, 0, 0}, {1, 0, 0}, {-1, 5, 0}, {1, 5, 0}}) {
        const WorldHit hit = trace(scene, emitter + Vec3d{0, 0, 3}, {0, 0, -1});
        CHECK(near(hit.p, emitter + Vec3d{0, 0, 0.1}));
        CHECK(hit.hit.light != nullptr);
        CHECK(near(trace(scene, emitter + Vec3d{0, 0.5, 3}, {0, 0, -1}).p, emitter + Vec3d{0, 0.5, 0.2}));
    }
    CHECK(scene.built().facts.bounds.lower.y == doctest::Approx(-0.1));
    CHECK(scene.built().facts.bounds.upper.y == doctest::Approx(5.7));
}

TEST_CASE("geometry: an object in itself is an error that says how, and not a hang") {
    const auto direct = build("object a { instance a }\ninstance a");
    CHECK(codes(direct).find("E0602") != std::string::npos);
    CHECK(direct.report().find("`a` → `a`") != std::string::npos);
    const auto around = build("object a { instance b }\nobject b { instance c }\nobject c { instance a }\ninstance b");
    CHECK(codes(around).find("E0602") != std::string::npos);
    CHECK(around.report().find("`b` → `c` → `a` → `b`") != std::string::npos);
    CHECK(build("instance nothing").diagnostics().hasErrors());
}

TEST_CASE("geometry: facts count what is there") {
    const auto scene = build("shape sphere\nshape quad\nshape plane\n"
                             "shape mesh { points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0; - -0.5 0.5 0 };"
                             " faces { - 0 1 2 3; - 0 2 3; - 0 1 2 3 4 } }\n"
                             "light disk { radius 1; radiance 1 }");
    REQUIRE(scene.report() == "");
    const SceneFacts& f = scene.built().facts;
    CHECK(f.shapes == 4);
    CHECK(f.analytic == 2);
    CHECK(f.quads == 2);
    CHECK(f.triangles == 1 + 3);
    CHECK(f.lights == 2);
    CHECK(f.lightList.size() == 2);
    CHECK(f.lightList[1].watts > 0);
}

TEST_CASE("geometry: mesh files") {
    const MeshFileForTest obj("mesh.obj", "v 0 0 0\nv 1000 0 0\nv 1000 1000 0\nv 0 1000 0\nf 1 2 3 4\n");
    const auto scene = TestScene::parse("scene 1 length=mm\ncamera { from 0 0 5 m; look-at 0 0 0 }\n" + kSky +
                                        fmt::format("shape mesh \"{}\" {{ material diffuse }}", obj.path()));
    REQUIRE(scene.report() == "");
    CHECK(near(trace(scene, {0.7, 0.2, 5}, {0, 0, -1}).p, {0.7, 0.2, 0})); // a file's numbers are bare lengths
    CHECK(scene.built().facts.files == std::vector<std::string>{obj.path()});
    CHECK(build("shape mesh \"no/such.obj\"").diagnostics().hasErrors());
    const MeshFileForTest damaged("damaged.obj", "v 0 0 0\nv 1 0\nf 1 2 9\n");
    const auto bad = build(fmt::format("shape mesh \"{}\"", damaged.path()));
    CHECK(codes(bad) == "E0402");
    CHECK(bad.diagnostics().all().front().span.valid());
}

TEST_CASE("geometry: meshes that are none") {
    const std::string points = "points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 0 0 }";
    CHECK(codes(build("shape mesh { " + points + "; faces { - 0 1 7 } }")) == "E0611");
    CHECK(codes(build("shape mesh { " + points + "; faces { - 0 1 } }")) == "E0309");
    CHECK(codes(build("shape mesh { " + points + "; faces { - 0 1 3 } }")).find("E0604") != std::string::npos);
    CHECK(codes(build("shape mesh { " + points + "; faces { - 0 1 2; - 0 1 3 } }")) == "W0603");
}

TEST_CASE("geometry: shapes that cannot be") {
    CHECK(build("shape sphere { radius 0 }").diagnostics().hasErrors());
    CHECK(build("shape sphere { radius -1 }").diagnostics().hasErrors());
    CHECK(build("shape quad { points 0 0 0  1 0 0  2 0 0  3 0 0 }").diagnostics().hasErrors());
    CHECK(build("shape sphere { transform { scale 0 } }").diagnostics().hasErrors());
    CHECK(codes(build("shape plane { emission 1 }")) == "E0606");
}

} // namespace abbe::test

// `instances`: places from files, grids and surfaces; what is refused; objects inside objects.
#include "scene_test_fixture.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>
#include <set>

namespace abbe::test {
namespace {

class PlyFile {
  public:
    PlyFile(const std::string& properties, const std::string& rows, int count)
        : path_(std::filesystem::temp_directory_path() / "abbe_instances_test.ply") {
        std::string header = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\n", count);
        std::size_t at = 0;
        while (at < properties.size()) {
            const std::size_t end = std::min(properties.find(' ', at), properties.size());
            header += "property float " + properties.substr(at, end - at) + "\n";
            at = end + 1;
        }
        std::ofstream(path_) << header << "end_header\n" << rows;
    }
    ~PlyFile() { std::filesystem::remove(path_); }
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

// A box that is 0.1 wide (x), 0.2 high (y) and 0.4 deep (z), standing on the origin.
const std::string kBox = "object box { shape mesh {\n"
                         "points { - -0.05 0 -0.2; - 0.05 0 -0.2; - 0.05 0.2 -0.2; - -0.05 0.2 -0.2\n"
                         "         - -0.05 0 0.2; - 0.05 0 0.2; - 0.05 0.2 0.2; - -0.05 0.2 0.2 }\n"
                         "faces { - 3 2 1 0; - 4 5 6 7; - 0 1 5 4; - 1 2 6 5; - 2 3 7 6; - 3 0 4 7 } } }\n";

bool metAt(const TestScene& scene, Vec3d p, Vec3d direction) {
    const WorldHit hit = trace(scene, p - normalize(direction) * 3, direction);
    return hit.met && near(hit.p, p, 1e-4);
}

TestScene points(const std::string& properties, const std::string& rows, int count, const std::string& more = "") {
    const PlyFile file(properties, rows, count);
    return build(kBox + "instances box { points \"" + file.path() + "\"; " + more + " }");
}

} // namespace

TEST_CASE("instances: points of a file with quaternions, normals and sizes") {
    const auto plain = points("x y z", "1 0 0\n0 2 0\n", 2);
    REQUIRE(plain.report() == "");
    CHECK(plain.built().facts.instances == 2);
    CHECK(metAt(plain, {1.05, 0.1, 0}, {-1, 0, 0}));
    CHECK(metAt(plain, {0, 2.2, 0}, {0, -1, 0}));

    // A quarter turn about y takes the depth to x; then one about z, the height to -x.
    const auto turned = points("x y z qx qy qz qw", "0 0 0 0 1 0 1\n9 0 0 0 0 2 2\n", 2);
    REQUIRE(turned.report() == "");
    CHECK(metAt(turned, {0.2, 0.1, 0}, {-1, 0, 0}));
    CHECK(metAt(turned, {8.8, 0, 0}, {1, 0, 0}));

    const auto normals = points("x y z nx ny nz radius", "0 0 0 1 0 0 1\n9 0 0 0 -5 0 2\n", 2);
    REQUIRE(normals.report() == "");
    CHECK(metAt(normals, {0.2, 0, 0}, {-1, 0, 0}));
    CHECK(metAt(normals, {9, -0.4, 0}, {0, 1, 0})); // upside down, twice as large

    const auto sizes = points("x y z sx sy sz", "0 0 0 2 1 -1\n", 1, "transform { translate 0 1 0 }");
    REQUIRE(sizes.report() == "");
    CHECK(metAt(sizes, {0.1, 1.1, 0}, {-1, 0, 0}));
    CHECK(metAt(sizes, {0, 1.2, 0}, {0, -1, 0}));
    CHECK(dot(trace(sizes, {0, 5, 0}, {0, -1, 0}).hit.ng, Vec3(0, 1, 0)) > 0.99f); // mirrored, outside is outside
}

TEST_CASE("instances: files that place nothing are located errors") {
    CHECK(points("x y z qx qy qz", "0 0 0 1 0 0\n", 1).report().find("`qz` but no `qw`") != std::string::npos);
    CHECK(codes(points("x y z scale", "0 0 0 1\n0 0 0 0\n", 2)) == "E0631");
    CHECK(points("x y z scale", "0 0 0 1\n0 0 0 0\n", 2).report().find("place 1 cannot be used") != std::string::npos);
    CHECK(codes(points("x y z scale", "0 0 0 1e-20\n", 1)) == "E0631");
    CHECK(codes(points("x y z qx qy qz qw", "0 0 0 0 0 0 0\n", 1)) == "E0631");
    CHECK(codes(points("x y z nx ny nz", "0 0 0 0 0 0\n", 1)) == "E0631");
    CHECK(codes(points("x y z", "0 nan 0\n", 1)) == "E0402");
    CHECK(codes(points("x y z", "0 0\n", 1)) == "E0402");
    CHECK(codes(points("x y", "0 0\n", 1)) == "E0402");
}

TEST_CASE("instances: what is said wrongly") {
    CHECK(codes(build(kBox + "instances box")) == "E0630");
    CHECK(codes(build(kBox + "instances box { grid 2 1.5 2 }")) == "E0630");
    CHECK(codes(build(kBox + "instances box { grid 2 1 2; area 1 1 }")) == "E0630");
    CHECK(build(kBox + "instances box { grid 2 1 2; scatter 4 }").diagnostics().hasErrors());
    CHECK(codes(build(kBox + "instances box { scater 4 }")) == "E0201");
    CHECK(build(kBox + "instances bix { scatter 4 }").report().find("did you mean `box`") != std::string::npos);
    CHECK(build(kBox + "shape ground quad\ninstances box { scatter 4; over grond }")
              .report()
              .find("did you mean `ground`") != std::string::npos);
    CHECK(codes(build(kBox + "shape ball sphere\ninstances box { scatter 4; over ball }")) == "E0632");
    CHECK(codes(build(kBox + "group { shape ground quad }\ninstances box { scatter 4; over ground }")) == "E0632");
    CHECK(build("object a { instances a { scatter 3 } }\ninstance a").report().find("contains itself") !=
          std::string::npos);
    CHECK(codes(build(kBox + "instance box { transform { scale 0 1 1 } }")).find("E0") != std::string::npos);
    CHECK(codes(build(kBox + "instances box { grid 1000 1000 1000 }")) == "E0607");
}

TEST_CASE("instances: a grid is centred and has its spacing") {
    const auto scene = build(kBox + "instances box { grid 3 1 2; spacing 2 9 4 }");
    REQUIRE(scene.report() == "");
    CHECK(scene.built().facts.instances == 6);
    for (const double x : {-2.0, 0.0, 2.0})
        for (const double z : {-2.0, 2.0}) CHECK(metAt(scene, {x, 0.2, z}, {0, -1, 0}));
    CHECK_FALSE(trace(scene, {1, 5, 0}, {0, -1, 0}).met);
}

TEST_CASE("instances: scattered places lie on the surface, evenly, and depend on the seed alone") {
    const std::string quad = "shape ground quad { points -5 0 5  5 0 5  5 0 -5  -5 0 -5 }\n";
    const std::string pin = "object pin { shape sphere { center 0 0.3 0; radius 0.01 } }\n";
    const auto count = [](const TestScene& scene, double x0, double x1) {
        int found = 0;
        for (double x = x0; x < x1; x += 0.015)
            for (double z = -5; z < 5; z += 0.015) found += trace(scene, {x, 1, z}, {0, -1, 0}).p.y > 0.2;
        return found;
    };
    const auto scene = build(pin + quad + "instances pin { scatter 256; over ground; seed 4 }");
    REQUIRE(scene.report() == "");
    CHECK(scene.built().facts.instances == 256);
    // Each pin shows itself to one or two of the rays.
    const int left = count(scene, -5, 0), right = count(scene, 0, 5);
    CHECK(left > 128);
    CHECK(std::abs(left - right) < 0.2 * left);
    const auto again = build(pin + quad + "instances pin { scatter 256; over ground; seed 4 }");
    const auto other = build(pin + quad + "instances pin { scatter 256; over ground; seed 5 }");
    CHECK(count(again, -5, -4) == count(scene, -5, -4));
    int same = 0, met = 0;
    for (double x = -5; x < -3; x += 0.015)
        for (double z = -5; z < 5; z += 0.015) {
            const bool a = trace(scene, {x, 1, z}, {0, -1, 0}).p.y > 0.2;
            met += a;
            same += a && trace(other, {x, 1, z}, {0, -1, 0}).p.y > 0.2;
        }
    CHECK(met > 20);
    CHECK(same < met / 4);

    // On a disk that faces +x the pins stand outwards, within its rim, when they are aligned.
    const auto aligned = build(pin + "shape wall disk { normal 1 0 0; radius 2 }\n"
                                     "instances pin { scatter 500; over wall; align on; scale 1 2 }");
    REQUIRE(aligned.report() == "");
    int heads = 0;
    for (double y = -2.5; y < 2.5; y += 0.02)
        for (double z = -2.5; z < 2.5; z += 0.02) {
            const WorldHit hit = trace(aligned, {4, y, z}, {-1, 0, 0});
            if (!hit.met || hit.p.x < 0.1) continue;
            ++heads;
            CHECK(hit.p.x < 0.65);
            CHECK(std::hypot(y, z) < 2.03);
        }
    CHECK(heads > 300);
}

TEST_CASE("instances: a forest of forests stays small, and lights in it are lights") {
    const auto scene = build("object leaf { shape sphere { radius 0.01 } }\n"
                             "object tree { instances leaf { grid 100 100 1; spacing 0.1 0.1 0.1 } }\n"
                             "object forest { instances tree { grid 100 1 100; spacing 20 1 20 }\n"
                             "  shape sphere { center 0 50 0; radius 1; emission 1 } }\n"
                             "instances forest { grid 2 1 2; spacing 5000 1 5000 }");
    REQUIRE(scene.report() == "");
    CHECK(scene.built().facts.instances == 400'000'000);
    CHECK(scene.scene().lights.size() == 1 + 4);
    CHECK(scene.built().facts.bounds.upper.x == doctest::Approx(2500 + 990 + 4.96));
    // The middle leaves of a tree in the middle of a forest.
    const Vec3d leaf = Vec3d{2500, 0, -2500} + Vec3d{10, 0, 10} + Vec3d{0.05, 0.05, 0};
    const WorldHit hit = trace(scene, leaf + Vec3d{0, 0, 3}, {0, 0, -1});
    REQUIRE(hit.met);
    CHECK(near(hit.p, leaf + Vec3d{0, 0, 0.01}, 5e-4));
    CHECK(trace(scene, {-2500, 60, 2500}, {0, -1, 0}).hit.light != nullptr);
}

TEST_CASE("instances: 31 levels are followed, 33 are refused") {
    const auto chain = [](int levels) {
        std::string text = "object o0 { shape sphere { radius 0.5 } }\n";
        for (int i = 1; i < levels; ++i)
            text += fmt::format("object o{} {{ instance o{} {{ transform {{ translate 0 1 0 }} }} }}\n", i, i - 1);
        return build(text + fmt::format("instance o{}", levels - 1));
    };
    const auto deep = chain(31);
    REQUIRE(deep.report() == "");
    CHECK(metAt(deep, {0, 30.5, 0}, {0, -1, 0}));
    CHECK(codes(chain(34)).find("E0633") != std::string::npos);
    CHECK(codes(chain(200)).find("E0633") != std::string::npos);
}

// Ray by ray: an instance has the hit points, normals and tangents of the mesh that has its transform in the vertices.
namespace {

// Two triangles with texture coordinates and normals that lean far from those of the faces and from each other.
class LeaningObj {
  public:
    LeaningObj() : path_(std::filesystem::temp_directory_path() / "abbe_instance_frames_test.obj") {
        std::ofstream(path_) << "v -1 -1 0\nv 1 -1 0.1\nv 1 1 0\nv -1 1 0.3\n"
                                "vt 0 0\nvt 1 0.2\nvt 0.9 1\nvt 0 1\n"
                                "vn 0.5 0.1 1\nvn -0.3 0.4 1\nvn 0.2 0.6 1\nvn 0.1 -0.5 1\n"
                                "f 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/4\n";
    }
    ~LeaningObj() { std::filesystem::remove(path_); }
    LeaningObj(const LeaningObj&) = delete;
    LeaningObj& operator=(const LeaningObj&) = delete;
    std::string shape(const std::string& transform) const {
        return fmt::format("shape mesh \"{}\" {{ {} }}\n", path_.string(), transform);
    }

  private:
    std::filesystem::path path_;
};

} // namespace

TEST_CASE("instances: normals and tangents are those of the transformed mesh, mirrors and uneven scales included") {
    const LeaningObj mesh;
    for (const char* steps : {"scale -1 1 1", "scale 0.4 -1.5 0.9; rotate z 30 deg", "scale 3 0.5 -1; rotate x 35 deg",
                              "scale -2 -0.5 -1; rotate y 20 deg", "scale 0.5 2 1"}) {
        INFO(std::string(steps));
        const std::string transform = fmt::format("transform {{ {} }}", steps);
        const auto baked = build(mesh.shape(transform));
        const auto placed = build("object o { " + mesh.shape("") + " }\ninstance o { " + transform + " }\n");
        const auto halves =
            build("object a { " + mesh.shape("") + " }\nobject b { instance a { " + transform + " } }\ninstance b");
        REQUIRE(baked.report() == "");
        int met = 0;
        for (int i = 0; i < 900; ++i) {
            const Vec3d to{-1.5 + 0.1 * (i % 30), -1.5 + 0.1 * static_cast<int>(i / 30), 0};
            const WorldHit a = trace(baked, {0.1, 0.2, 5}, to - Vec3d{0.1, 0.2, 5});
            if (!a.met) continue;
            for (const TestScene* scene : {&placed, &halves}) {
                const WorldHit b = trace(*scene, {0.1, 0.2, 5}, to - Vec3d{0.1, 0.2, 5});
                REQUIRE(b.met);
                if (a.hit.primitive != b.hit.primitive) continue; // on the edge between the two
                ++met;
                CHECK(near(a.p, b.p));
                CHECK(near(Vec3d(a.hit.ng), Vec3d(b.hit.ng)));
                CHECK(near(Vec3d(a.hit.shading.z), Vec3d(b.hit.shading.z)));
                CHECK(near(Vec3d(a.hit.shading.x), Vec3d(b.hit.shading.x)));
            }
        }
        CHECK(met > 200);
    }
}

} // namespace abbe::test

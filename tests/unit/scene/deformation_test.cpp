// Shapes with keys: where they are while the shutter is open, and what is wrong with keys.
#include "geometry/deforming_mesh.h"
#include "scene_test_fixture.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace abbe::test {
namespace {

const std::string kCamera = "scene 1\ncamera { from 0 0 5; look-at 0 0 0; shutter 1 s }\n" + kSky;

TestScene withShutter(const std::string& body) { return TestScene::parse(kCamera + body); }

// How far away a ray down the z axis from (x, y, 4) meets something; 0 if nothing.
double depthAt(const TestScene& scene, double x, double y, double time) {
    SurfaceHit hit;
    const Ray ray{Vec3(Vec3d{x, y, 4} - scene.scene().origin), {0, 0, -1}, kInfinity, static_cast<float>(time)};
    return scene.scene().intersector->intersect(ray, hit) ? static_cast<double>(hit.distance) : 0;
}

std::string square(double z) { return fmt::format("points {{ - -1 -1 {0}; - 1 -1 {0}; - 1 1 {0}; - -1 1 {0} }}", z); }
std::string key(double time, const std::string& body) { return fmt::format("at {} s {{ {} }}\n", time, body); }
std::string mesh(const std::string& body) { return "shape mesh { faces { - 0 1 2 3 }\n" + body + "}\n"; }

// A PLY file of a square at z in the temporary folder.
std::string squareFile(const std::string& name, double z, bool triangles = false) {
    const auto path = std::filesystem::temp_directory_path() / ("abbe_deformation_" + name + ".ply");
    std::ofstream file(path);
    file << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         << "element face " << (triangles ? 2 : 1) << "\nproperty list uchar int vertex_indices\nend_header\n"
         << fmt::format("-1 -1 {0}\n1 -1 {0}\n1 1 {0}\n-1 1 {0}\n", z)
         << (triangles ? "3 0 1 2\n3 0 2 3\n" : "4 0 1 2 3\n");
    return fmt::format("file \"{}\"", path.string());
}

} // namespace

TEST_CASE("deformation: a mesh follows its keys while the shutter is open") {
    const auto scene = withShutter(mesh(key(0, square(0)) + key(0.5, square(2)) + key(1, square(1))));
    REQUIRE(scene.report() == "");
    for (const double t : {0.0, 0.1, 0.4, 0.5, 0.7, 1.0}) {
        CAPTURE(t);
        const double z = t <= 0.5 ? 4 * t : 3 - 2 * t;
        CHECK(depthAt(scene, 0.3, -0.2, t) == doctest::Approx(4 - z));
    }
    CHECK(depthAt(scene, 1.2, 0, 0.5) == 0);
    CHECK(scene.built().facts.bounds.upper.z == doctest::Approx(2));
    CHECK(scene.built().facts.quads == 1);
}

TEST_CASE("deformation: before the first key and after the last the shape holds still") {
    const auto scene = withShutter(mesh(key(0.25, square(0)) + key(0.75, square(1))));
    REQUIRE(scene.report() == "");
    for (const auto& [t, z] : {std::pair{0.0, 0.0}, {0.2, 0.0}, {0.5, 0.5}, {0.9, 1.0}, {1.0, 1.0}})
        CHECK(depthAt(scene, 0, 0, t) == doctest::Approx(4 - z));
    const auto early = withShutter(mesh(key(-2, square(0)) + key(-1, square(1))));
    for (const double t : {0.0, 1.0}) CHECK(depthAt(early, 0, 0, t) == doctest::Approx(3));
    // Keys from long before to long after: the exposure sees their middle.
    const auto middle = withShutter(mesh(key(-1, square(0)) + key(3, square(2))));
    for (const double t : {0.0, 0.5, 1.0}) CHECK(depthAt(middle, 0, 0, t) == doctest::Approx(4 - (0.5 + 0.5 * t)));
}

TEST_CASE("deformation: without a shutter the shape stands where it is at time 0") {
    const auto scene = build(mesh(key(-1, square(0)) + key(1, square(1))));
    REQUIRE(scene.report() == "");
    for (const double t : {0.0, 0.5, 1.0}) CHECK(depthAt(scene, 0, 0, t) == doctest::Approx(3.5));
    CHECK(dynamic_cast<const DeformingMesh*>(scene.scene().shapes.at(0).get()) == nullptr); // and costs no more
}

TEST_CASE("deformation: keys on no grid are met within what the warning says") {
    const auto scene = withShutter(mesh(key(0, square(0)) + key(0.3137, square(1)) + key(1, square(0))));
    REQUIRE(codes(scene) == "W0680");
    const double off = 4 - 1 - depthAt(scene, 0, 0, 0.3137);
    CHECK(std::abs(off) > 1e-4);
    CHECK(std::abs(off) < 0.02);
    CHECK(scene.report().find(fmt::format("{:.2g} m", std::abs(off))) != std::string::npos);
    for (const double t : {0.1, 0.25, 0.5, 0.8})
        CHECK(depthAt(scene, 0, 0, t) == doctest::Approx(t < 0.3137 ? 4 - t / 0.3137 : 4 - (1 - t) / 0.6863));
    // A bend that is none: at even speed nothing moves off its place.
    CHECK(codes(withShutter(mesh(key(0, square(0)) + key(0.3137, square(0)) + key(1, square(0))))) == "");
}

TEST_CASE("deformation: meshes from files") {
    const std::string a = squareFile("a", 0), b = squareFile("b", 1.5), other = squareFile("c", 1, true);
    const auto scene = withShutter("shape mesh { " + key(0, a) + "at \"1/1 s\" { " + b + " }\n}\n");
    REQUIRE(scene.report() == "");
    CHECK(depthAt(scene, 0, 0, 0.5) == doctest::Approx(3.25));
    CHECK(scene.built().facts.files.size() == 2);
    const auto differing = withShutter("shape mesh { " + key(0, a) + key(1, other) + "}\n");
    CHECK(codes(differing) == "E0680");
    CHECK(differing.report().find("4 points and 2 faces, but 4 and 1 in the first key") != std::string::npos);
    CHECK(codes(withShutter("shape mesh { " + key(0, a) + key(1, "file \"none-such.ply\"") + "}\n")) == "E0401");
}

TEST_CASE("deformation: subdivision, with one plan for all times") {
    const std::string cube = "shape subdivision { scheme bilinear; dicing 3\n"
                             "faces { - 0 1 2 3; - 7 6 5 4; - 0 4 5 1; - 1 5 6 2; - 2 6 7 3; - 3 7 4 0 }\n";
    const auto at = [](double z) {
        return fmt::format("points {{ - -1 1 0; - 1 1 0; - 1 -1 0; - -1 -1 0; - -1 1 {0}; - 1 1 {0}; - 1 -1 {0}; "
                           "- -1 -1 {0} }}",
                           z);
    };
    const auto scene = withShutter(cube + key(0, at(1)) + key(0.5, at(3)) + key(1, at(2)) + "}\n");
    REQUIRE(scene.report() == "");
    CHECK(depthAt(scene, 0.3, 0.1, 0.25) == doctest::Approx(2));
    CHECK(depthAt(scene, 0.3, 0.1, 0.5) == doctest::Approx(1));
    CHECK(depthAt(scene, 0.3, 0.1, 0.75) == doctest::Approx(1.5));
    CHECK(scene.built().facts.quads == 6 * 64);
    CHECK(codes(withShutter(cube + key(0, at(1)) + key(1, "points { - 0 0 0; - 1 0 0; - 1 1 0 }") + "}\n")) == "E0660");
    CHECK(codes(withShutter(cube + key(0, at(1)) + key(1, at(1) + "\n" + squareFile("d", 0)) + "}\n")) == "E0681");
}

TEST_CASE("deformation: curves and points, with radii that change") {
    const std::string strand = "points { - 0 -1 0; - 0 1 0 }\n", moved = "points { - 1 -1 0; - 1 1 0 }\n";
    const auto curves = withShutter("shape curves { basis linear\n" + key(0, strand + "radius 0.1") +
                                    key(1, moved + "radius 0.5") + "}\n");
    REQUIRE(curves.report() == "");
    CHECK(depthAt(curves, 0, 0, 0) == doctest::Approx(3.9));
    CHECK(depthAt(curves, 0.5, 0, 0.5) == doctest::Approx(3.7)); // half-way, radius 0.3
    CHECK(depthAt(curves, 0.1, 0, 0.5) == 0);
    CHECK(depthAt(curves, 1, 0, 1) == doctest::Approx(3.5));

    const auto points = withShutter("shape points { radius 0.25\n" + key(0, "points { - 0 0 0; - 0 1 0 }") +
                                    key(1, "points { - 1 0 0; - 0 1 2 }") + "}\n");
    REQUIRE(points.report() == "");
    CHECK(depthAt(points, 0.5, 0, 0.5) == doctest::Approx(3.75));
    CHECK(depthAt(points, 0, 1, 0.5) == doctest::Approx(2.75));

    const auto wrong = [](const std::string& body) {
        return codes(withShutter("shape curves { basis linear\n" + body + "}\n"));
    };
    CHECK(wrong("radius 1\n" + key(0, strand + "radius 0.1") + key(1, moved + "radius 0.5")) == "E0681");
    CHECK(wrong("radius 1\n" + key(0, strand) + key(1, "points { - 0 0 0; - 1 1 1; - 2 2 2 }")) == "E0680");
    CHECK(wrong(key(0, strand) + key(1, moved)) == "E0621"); // no radius
    CHECK(codes(withShutter("shape points { radius 1\n" + key(0, strand) + key(1, "points { - 0 0 0 }") + "}\n")) ==
          "E0680");
}

TEST_CASE("deformation: in an object, placed still and moving") {
    const std::string object = "object sheet { " + mesh(key(0, square(0)) + key(1, square(1))) + "}\n";
    const auto still = withShutter(object + "instance sheet { transform { scale 2; translate 0 0 -1 } }\n");
    REQUIRE(still.report() == "");
    CHECK(depthAt(still, 1.5, 1.5, 0.5) == doctest::Approx(4)); // 2 · 0.5 - 1
    const auto moving = withShutter(object + "instance sheet { transform { at 0 s { translate 0 0 0 }\n"
                                             "at 1 s { translate 4 0 1 } } }\n");
    REQUIRE(moving.report() == "");
    CHECK(depthAt(moving, 2, 0, 0.5) == doctest::Approx(3)); // both half-way
    CHECK(depthAt(moving, 0, 0, 0.5) == 0);
}

TEST_CASE("deformation: keys that make no sense are located errors") {
    const auto wrong = [](const std::string& body) { return codes(withShutter(mesh(body))); };
    CHECK(wrong(key(0, square(0)) + key(1, "points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0; - 0 2 0 }")) == "E0680");
    CHECK(wrong(key(1, square(0)) + key(0, square(1))) == "E0313"); // order
    CHECK(wrong(square(0) + "\n" + key(0, square(0)) + key(1, square(1))) == "E0681");
    CHECK(wrong(key(0, square(0)) + key(1, "")) == "E0681");                 // states nothing
    CHECK(wrong(key(0, square(0)) + key(1, squareFile("e", 1))) == "E0681"); // points, then a file
    CHECK(wrong(key(0, square(0)) + key(1, square(1)) + "emission 1\n") == "E0682");
    CHECK(wrong(key(0, square(0)) + "at 1 m { " + square(1) + " }\n") == "E0302");
    CHECK(wrong(key(0, square(0)) + key(1, "radius 1; " + square(1))) == "E0201");
    // Faces are missing, or name points that are not there.
    CHECK(codes(withShutter("shape mesh { " + key(0, square(0)) + key(1, square(1)) + "}\n")) == "E0604");
    CHECK(codes(withShutter("shape mesh { faces { - 0 1 7 }\n" + key(0, square(0)) + key(1, square(1)) + "}\n")) ==
          "E0611");
    CHECK(codes(withShutter("shape sphere { " + key(0, "radius 1") + "}\n")) != "");
    CHECK(codes(withShutter("light mesh { faces { - 0 1 2 3 }; luminance 10 nits\n" + key(0, square(0)) + "}\n")) !=
          "");
}

} // namespace abbe::test

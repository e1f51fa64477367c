// Shapes that media fill must be closed.
#include "scene/shape_builder.h"
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const std::string kFog = "; material boundary; interior homogeneous { extinction 1 per-m } }\n";
const std::string kCorners = "points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0; - 0 0 1; - 1 0 1; - 1 1 1; - 0 1 1 }\n";
const std::string kFive = "- 3 2 1 0; - 4 5 6 7; - 0 1 5 4; - 1 2 6 5; - 2 3 7 6";

std::string cube(const std::string& type, const std::string& sixth) {
    return "shape " + type + " { " + kCorners + "faces { " + kFive + sixth + " }" + kFog;
}

} // namespace

TEST_CASE("interiors: closed shapes hold them") {
    for (const std::string shape :
         {"sphere { radius 1", "box { size 1 1 1", "cylinder { height 2", "cone { height 2", "torus { major-radius 1",
          "plane { center 0 -3 0", "points { points { - 0 0 0; - 1 0 0 }; radius 0.2"})
        CHECK_MESSAGE(codes(build("shape " + shape + kFog)) == "", shape);
    for (const std::string type : {"mesh", "subdivision"}) CHECK(codes(build(cube(type, "; - 3 0 4 7"))) == "");
}

TEST_CASE("interiors: shapes without an inside are refused where they ask for one") {
    for (const std::string shape : {"quad { size 1 1", "disk { radius 1", "cylinder { caps off", "cone { caps off",
                                    "curves { points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0 }; radius 0.1",
                                    "points { points { - 0 0 0; - 1 0 0 }; radius 0.2; form disk"}) {
        const auto scene = build("shape " + shape + kFog);
        CHECK_MESSAGE(codes(scene) == "E0645", shape << ": " << scene.report());
    }
    CHECK(codes(build("shape cylinder { caps off }\nshape quad { size 1 1 }\n")) == "");
}

TEST_CASE("interiors: meshes and cages with holes or turned faces are reported with the number of edges") {
    for (const std::string type : {"mesh", "subdivision"}) {
        const auto open = build(cube(type, ""));
        CHECK(codes(open) == "W0694");
        CHECK(open.diagnostics().all()[0].label.find("4 edges of a single face") != std::string::npos);
    }
    const auto turned = build(cube("mesh", "; - 7 4 0 3"));
    CHECK(codes(turned) == "W0694");
    CHECK(turned.diagnostics().all()[0].label.find("4 edges between faces that are turned") != std::string::npos);
    CHECK(codes(build("shape subdivision { " + kCorners + "faces { " + kFive + "; - 3 0 4 7 }; holes 2" + kFog)) ==
          "W0694");
}

TEST_CASE("interiors: behind what no light passes nothing is seen of them") {
    const auto filled = [](const std::string& material) {
        return codes(
            build("shape sphere { material " + material + "; interior homogeneous { extinction 1 per-m } }\n"));
    };
    CHECK(filled("conductor { index metal Au }") == "W0695");
    CHECK(filled("diffuse") == "W0695");
    CHECK(filled("layered { base diffuse }") == "W0695");
    CHECK(filled("diffuse { opacity 0.5 }") == "");
    CHECK(filled("dielectric { ior 1.3 }") == "");
    CHECK(filled("thin-dielectric") == "");
}

TEST_CASE("interiors: vertices in one place are one, faces without an area none") {
    // A tetrahedron whose faces share no vertex, with a sliver between two of them.
    const Vec3 p[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    MeshData mesh;
    for (const auto& face : {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{1, 2, 3}, std::array{0, 3, 2}}) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const int corner : face) mesh.positions.push_back(p[corner]);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    CHECK(openEdges(mesh).closed());
    mesh.triangles.push_back({0, 1, 0});
    CHECK(openEdges(mesh).closed());
    mesh.positions[4].x += 1e-3f;
    CHECK(openEdges(mesh).open == 4);
    CHECK(openEdges(MeshData{}).closed());
}

} // namespace abbe::test

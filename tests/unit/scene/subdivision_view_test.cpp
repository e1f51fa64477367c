// Subdivision surfaces out of scene text: which camera they are diced for, texture coordinates in place, and materials
// of groups of faces.
#include "geometry/mesh.h"
#include "scene_test_fixture.h"
#include "support/subdivision_reference.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>

using namespace abbe;
using namespace abbe::test;

namespace {

const std::string kViewCube =
    "points { - -1 -1 -1; - 1 -1 -1; - -1 1 -1; - 1 1 -1; - -1 -1 1; - 1 -1 1; - -1 1 1; - 1 1 1 }\n"
    "faces { - 0 2 3 1; - 4 5 7 6; - 0 1 5 4; - 2 6 7 3; - 0 4 6 2; - 1 3 7 5 }\n";

std::string viewedShape(const std::string& more) { return "shape subdivision {\n" + kViewCube + more + "}\n"; }

const MeshData& meshOf(const TestScene& scene) {
    const Shape* s = scene.scene().shapes.at(0).get();
    if (const auto* parts = dynamic_cast<const FaceMaterials*>(s)) s = &parts->inner();
    return dynamic_cast<const Mesh&>(*s).data();
}

double longestEdge(const MeshData& m, const auto& where) {
    double longest = 0;
    for (const auto& q : m.quads)
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 a = m.positions[q[i]], b = m.positions[q[(i + 1) % 4]];
            if (where(a)) longest = std::max(longest, static_cast<double>(length(b - a)));
        }
    return longest;
}

} // namespace

TEST_CASE("subdivision scene: pixels are those of the named camera") {
    // The render camera is 5 m away; the near one a quarter of that, the tall one sees pixels twice as large.
    const std::string near = "camera near { from 0 0 2.25; look-at 0 0 0 }\n";
    const auto everywhere = [](Vec3) { return true; };
    const std::string plain = "dicing 8 px\noffscreen 1\n", named = "dicing 8 px camera=near\noffscreen 1\n";
    const auto far = build(near + viewedShape(plain)), close = build(near + viewedShape(named));
    REQUIRE(codes(far) == "");
    REQUIRE(codes(close) == "");
    CHECK(longestEdge(meshOf(far), everywhere) > 1.5 * longestEdge(meshOf(close), everywhere));
    // The same as if the named camera rendered: distances are its own.
    BuildOptions options;
    options.camera = "near";
    const auto same = build(near + viewedShape(plain), options);
    REQUIRE(codes(same) == "");
    CHECK(meshOf(same).positions.size() == meshOf(close).positions.size());
    CHECK(test::openEdges(meshOf(close)) == 0);
}

TEST_CASE("subdivision scene: an unknown camera is named, with those that there are") {
    const auto wrong = build("camera near { from 0 0 2; look-at 0 0 0 }\n" + viewedShape("dicing 8 px camera=naer\n"));
    CHECK(codes(wrong) == "E0202");
    CHECK(wrong.report().find("did you mean `near`?") != std::string::npos);
    CHECK(wrong.advice().find("the cameras are `near`") != std::string::npos);
    CHECK(codes(build("camera near { from 0 0 2; look-at 0 0 0 }\n" + viewedShape("dicing 3 camera=near\n"))) ==
          "E0210");
    CHECK(codes(build(viewedShape("dicing 8 px view=near\n"))) == "E0210");
    // A camera that measures to the shape that is diced for it makes no circle.
    CHECK(codes(build("camera near { from 0 0 2; focus on=s }\nshape s subdivision {\n" + kViewCube +
                      "dicing 8 px camera=near\n}\n")) == "");
}

TEST_CASE("subdivision scene: what the camera does not see is coarser, and closed all the same") {
    // A long wall beside the camera: in front of it, and far behind.
    std::string wall = "shape subdivision {\npoints {";
    for (int i = 0; i <= 16; ++i)
        for (const int y : {-1, 1})
            for (const int z : {-1, 1})
                wall +=
                    " - " + std::to_string(y) + " " + std::to_string(z) + " " + std::to_string(4 - 3 * i + 20) + ";";
    wall += "}\nfaces {";
    for (int i = 0; i < 16; ++i)
        for (const auto& [a, b] : {std::pair{0, 1}, {1, 3}, {3, 2}, {2, 0}})
            wall += " - " + std::to_string(4 * i + a) + " " + std::to_string(4 * i + b) + " " +
                    std::to_string(4 * i + 4 + b) + " " + std::to_string(4 * i + 4 + a) + ";";
    wall += " - 0 2 3 1; - 64 65 67 66 }\ndicing 20 px\n";
    const auto diced = [&](const std::string& more) {
        auto scene = build(wall + more + "}\n");
        REQUIRE(codes(scene) == "W0696"); // the camera is in it
        return scene;
    };
    const auto even = diced("offscreen 1\n"), uneven = diced("offscreen 8\n"), usual = diced("");
    // Render space: the camera at the origin, looking along -z. Equally far from it, before and behind.
    const auto ahead = [](Vec3 p) { return p.z < -12 && p.z > -20; };
    const auto behind = [](Vec3 p) { return p.z > 12 && p.z < 20; };
    CHECK(longestEdge(meshOf(uneven), ahead) == doctest::Approx(longestEdge(meshOf(even), ahead)));
    CHECK(longestEdge(meshOf(even), behind) < 1.4 * longestEdge(meshOf(even), ahead));
    CHECK(longestEdge(meshOf(uneven), behind) > 4 * longestEdge(meshOf(uneven), ahead));
    CHECK(longestEdge(meshOf(usual), behind) > 2 * longestEdge(meshOf(usual), ahead));
    CHECK(longestEdge(meshOf(usual), behind) < 6 * longestEdge(meshOf(usual), ahead));
    CHECK(test::openEdges(meshOf(uneven)) == 0);
    CHECK(meshOf(uneven).quads.size() < meshOf(even).quads.size());
}

TEST_CASE("subdivision scene: texture coordinates in place") {
    const std::string corners = "uvs { - 0 0; - 1 0; - 1 1; - 0 1 }\nuv-faces { - 0 1 2 3; - 0 1 2 3; - 0 1 2 3; "
                                "- 0 1 2 3; - 0 1 2 3; - 0 1 2 3 }\n";
    const auto scene = build(viewedShape(corners + "dicing 3\n"));
    REQUIRE(codes(scene) == "");
    const MeshData& m = meshOf(scene);
    REQUIRE(m.uvs.size() == m.positions.size());
    float least = 1, most = 0;
    for (const Vec2 t : m.uvs) least = std::min({least, t.x, t.y}), most = std::max({most, t.x, t.y});
    CHECK(least == doctest::Approx(0));
    CHECK(most == doctest::Approx(1));
    CHECK(near(trace(scene, {0, 0, 4}, {0, 0, -1}).p, {0, 0, trace(scene, {0, 0, 4}, {0, 0, -1}).p.z}));
    const Vec2 middle = trace(scene, {0, 0, 4}, {0, 0, -1}).hit.uv;
    CHECK(middle.x == doctest::Approx(0.5));
    CHECK(middle.y == doctest::Approx(0.5));
    const auto perPoint = build(viewedShape("uvs { - 0 0; - 1 0; - 2 0; - 3 0; - 4 0; - 5 0; - 6 0; - 7 0 }\n"));
    REQUIRE(codes(perPoint) == "");
    CHECK(meshOf(perPoint).uvs.size() == meshOf(perPoint).positions.size());
    CHECK(codes(build(viewedShape("uvs 0 0 1\n"))) == "E0660");
    CHECK(codes(build(viewedShape("uvs 0 0 1 1\n"))) == "E0660");
    CHECK(codes(build(viewedShape("uvs { - 0 0 }\nuv-faces { - 0 0 0 0 }\n"))) == "E0660");
    CHECK(codes(build(
              viewedShape("uvs { - 0 0 }\nuv-faces { - 0 0 0; - 0 0 0 0; - 0 0 0 0; - 0 0 0 0; - 0 0 0 0; - 0 0 0 0 "
                          "}\n"))) == "E0660");
    CHECK(codes(build(viewedShape("uvs { - 0 0 }\nuv-faces { - 0 0 0 1; - 0 0 0 0; - 0 0 0 0; - 0 0 0 0; - 0 0 0 0; "
                                  "- 0 0 0 0 }\n"))) == "E0660");
}

TEST_CASE("groups of faces have their own materials, on meshes and subdivision surfaces") {
    const auto folder = std::filesystem::temp_directory_path() / "abbe_groups_test";
    std::filesystem::create_directories(folder);
    const std::string file = (folder / "cube.obj").string();
    std::ofstream(file) << "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
                           "g back\nf 1 3 4 2\ng front shiny\nf 5 6 8 7\ng sides\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n"
                           "f 2 4 8 6\ng sliver\nf 1 1 2\n";
    // Sides by the shape's own material; the sliver is removed and moves no face to another group.
    const std::string common =
        "material plain\nmaterial red group=front\nmaterial diffuse group=back { reflectance 0.1 }\n";
    const std::string materials =
        "material plain diffuse { reflectance 0.5 }\nmaterial red diffuse { reflectance 0.9 }\n";
    const std::string mesh = "shape mesh \"" + file + "\" {\n" + common;
    std::ofstream((folder / "cage.obj").string())
        << "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\n"
           "v -1 1 1\nv 1 1 1\ng back\nf 1 3 4 2\ng front shiny\nf 5 6 8 7\ng sides\nf 1 2 6 5\n"
           "f 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    const std::string cage = "shape subdivision \"" + (folder / "cage.obj").string() + "\" {\n" + common;
    for (const std::string& body : {materials + mesh + "}\n", materials + cage + "dicing 2\n}\n",
                                    materials + "object o { " + cage + "} }\ninstance o\n"}) {
        const auto scene = build(body);
        CAPTURE(scene.report());
        CHECK(codes(scene).find('E') == std::string::npos);
        const Material* front = trace(scene, {0, 0, 4}, {0, 0, -1}).hit.material;
        const Material* back = trace(scene, {0, 0, -4}, {0, 0, 1}).hit.material;
        const Material* side = trace(scene, {4, 0, 0}, {-1, 0, 0}).hit.material;
        const Material* top = trace(scene, {0, 4, 0}, {0, -1, 0}).hit.material;
        CHECK(front != back);
        CHECK(front != side);
        CHECK(back != side);
        CHECK(side == top);
    }
    for (const std::string& kind : {mesh, cage}) {
        const auto unknown = build(materials + kind + "material red group=fronts\n}\n");
        CHECK(codes(unknown).find("E0615") != std::string::npos);
        CHECK(unknown.report().find("did you mean") != std::string::npos);
        CHECK(unknown.advice().find("`sides`") != std::string::npos);
        CHECK(codes(build(materials + kind + "material plain group=front\n}\n")).find("E0208") != std::string::npos);
        CHECK(codes(build(materials + kind + "material plain\n}\n")).find("E0208") != std::string::npos);
        CHECK(codes(build(materials + kind + "material red group=shiny\n}\n")).find('E') == std::string::npos);
    }
    CHECK(codes(build(materials + "shape sphere { material red group=front }\n")).find("E0210") != std::string::npos);
    CHECK(codes(build(materials + viewedShape("material red part=front\n"))).find("E0210") != std::string::npos);
    // In place there are no groups.
    CHECK(codes(build(materials + viewedShape("material red group=front\n"))).find("E0615") != std::string::npos);
    std::filesystem::remove_all(folder);
}

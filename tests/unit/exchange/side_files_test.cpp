#include "exchange/shared/ply_writer.h"
#include "exchange/shared/side_files.h"
#include "io/mesh_file.h"
#include "unit/io/temporary_folder.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::exchange;

namespace fs = std::filesystem;

TEST_CASE("side files have safe names, each its own, in one folder beside the scene") {
    const TemporaryFolder folder;
    SideFiles files(fs::path(folder / "") / "room.scene");
    CHECK_FALSE(fs::exists(fs::path(folder / "") / "room-files"));
    const std::string bytes = "x";
    CHECK(files.write("../ball", "ply", bytes) == "room-files/---ball.ply");
    CHECK(files.write("ball", "ply", bytes) == "room-files/ball.ply");
    CHECK(files.write("ball", "ply", bytes) == "room-files/ball-2.ply");
    CHECK(files.write("", "ply", bytes) == "room-files/file.ply");
    CHECK(fs::exists(fs::path(folder / "") / "room-files/ball-2.ply"));
    CHECK(files.written() == 4);
}

TEST_CASE("files that were there are named from the scene's folder while that is near") {
    const TemporaryFolder folder;
    const fs::path home = fs::path(folder / "");
    SideFiles files(home / "a/b/c/room.scene");
    CHECK(files.refer(home / "a/b/c/t/x.png") == "t/x.png");
    CHECK(files.refer(home / "a/b/x.png") == "../x.png");
    CHECK(files.refer(home / "a/x.png") == "../../x.png");
    CHECK(fs::path(files.refer(home / "x.png")).is_absolute());
}

TEST_CASE("names are taken once") {
    NameTable names;
    CHECK(names.take("a", "material") == "a");
    CHECK(names.take("a", "material") == "a-2");
    CHECK(names.take("a-2", "material") == "a-2-2");
    CHECK(names.take("a", "material") == "a-3");
    CHECK(names.take("", "material") == "material");
    CHECK(names.take("", "material") == "material-2");
}

TEST_CASE("a mesh written as PLY is read as it was") {
    MeshData mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5f}, {2, 2, 2}};
    mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}};
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.25f, 0.5f}};
    mesh.quads = {{0, 1, 2, 3}};
    mesh.triangles = {{0, 1, 4}, {4, 3, 2}};
    mesh.attributes = {{"color", 3, {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1, 0.5f, 0.25f, 0.125f}}};
    const MeshData back = parsePly(binaryPly(mesh), "x.ply").mesh;
    CHECK(back.triangles == mesh.triangles);
    CHECK(back.quads == mesh.quads);
    REQUIRE(back.positions.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
        CHECK(back.positions[i] == mesh.positions[i]);
        CHECK(back.normals[i] == mesh.normals[i]);
        CHECK(back.uvs[i] == mesh.uvs[i]);
    }
    REQUIRE(back.attributes.size() == 1);
    CHECK(back.attributes[0].name == "color");
    CHECK(back.attributes[0].values == mesh.attributes[0].values);
}

TEST_CASE("side files that go nowhere have names alone") {
    const TemporaryFolder folder;
    SideFiles files(std::filesystem::path(folder / "") / "room.scene", SideFiles::Target::nowhere);
    CHECK(files.write("ball", "ply", std::string("x")) == "room-files/ball.ply");
    CHECK(files.write("ball", "ply", std::string("x")) == "room-files/ball-2.ply");
    CHECK_FALSE(std::filesystem::exists(folder / "room-files"));
}

TEST_CASE("names with numbers that were given to nobody are free, and others are not") {
    NameTable names;
    CHECK(names.take("ball-2", "x") == "ball-2");
    CHECK(names.take("ball", "x") == "ball");
    CHECK(names.take("ball", "x") == "ball-3");
    CHECK(names.take("ball-3", "x") == "ball-3-2");
    CHECK(names.take("ball-4", "x") == "ball-4");
    CHECK(names.take("", "x") == "x");
    CHECK(names.take("", "x") == "x-2");
}

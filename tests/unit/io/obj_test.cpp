#include "io/mesh_file.h"
#include "support/cpu_time.h"
#include "support/statistics.h"
#include "temporary_folder.h"

#include <algorithm>
#include <doctest/doctest.h>

using namespace abbe;
using test::Random;

namespace {

MeshFile meshOfObj(std::string_view text) { return parseObj(text, "t.obj"); }

std::string objError(std::string_view text) {
    try {
        meshOfObj(text);
    } catch (const IoError& e) {
        return e.what();
    }
    return "";
}

using Triangle = std::array<std::uint32_t, 3>;
using QuadIndices = std::array<std::uint32_t, 4>;

constexpr std::string_view kObjSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

double areaOf(const MeshData& m) {
    double sum = 0;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        sum += 0.5 * length(cross(Vec3d(m.positions[b]) - Vec3d(m.positions[a]),
                                  Vec3d(m.positions[c]) - Vec3d(m.positions[a])));
    };
    for (const auto& t : m.triangles) add(t[0], t[1], t[2]);
    for (const auto& q : m.quads) {
        add(q[0], q[1], q[3]);
        add(q[2], q[3], q[1]);
    }
    return sum;
}

} // namespace

TEST_CASE("obj: positions, triangles and quads") {
    const MeshFile f = meshOfObj(std::string(kObjSquare) + "f 1 2 3\nf 1 2 3 4\n");
    CHECK(f.mesh.positions.size() == 4);
    CHECK(f.mesh.positions[2] == Vec3(1, 1, 0));
    CHECK(f.mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
    CHECK(f.mesh.quads == std::vector<QuadIndices>{{0, 1, 2, 3}});
    CHECK(f.mesh.normals.empty());
    CHECK(f.mesh.uvs.empty());
}

TEST_CASE("obj: all ways to write a line") {
    const MeshFile f = meshOfObj("# comment \\\r\nv  0 0\t0  # after\r\n"
                                 "v +1 -0.0 1e-50 1.0\r\nv 1 1 0 0.5 0.5 0.5\r\n\r\n"
                                 "f 1 \\\r\n 2 \\\n3\r\n   f -3 -2 -1   \rf 1 2 3");
    CHECK(f.mesh.triangles.size() == 3);
    for (const auto& t : f.mesh.triangles) CHECK(t == Triangle{0, 1, 2});
    CHECK(f.mesh.positions[1] == Vec3(1, 0, 0));
}

TEST_CASE("obj: numbers are exact") {
    const MeshFile f =
        meshOfObj("v 0.1 1.17549435e-38 3.4028234e38\nv 16777217 -0.30000001192092896 1E2\nv 0 0 0\nf 1 2 3\n");
    CHECK(f.mesh.positions[0] == Vec3(0.1f, 1.17549435e-38f, 3.4028234e38f));
    CHECK(f.mesh.positions[1] == Vec3(16777216.f, -0.3f, 100.f));
}

TEST_CASE("obj: negative numbers count back from the line they stand on") {
    const MeshFile f = meshOfObj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4 -3 -1\n");
    CHECK(f.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}});
}

TEST_CASE("obj: faces may come before their vertices") {
    const MeshFile f = meshOfObj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    CHECK(f.mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
    CHECK(objError("f 1 2 3\nv 0 0 0\nv 1 0 0\n").find("line 1: vertex 3 of only 2") != std::string::npos);
}

TEST_CASE("obj: vertices are split where texture or normal differ, and only there") {
    const std::string text = std::string(kObjSquare) +
                             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0.25 0\nvn 0 0 1\nvn 0 1 0\n"
                             "f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\nf 1/2/1 2/2/1 3/3/2\n";
    const MeshFile f = meshOfObj(text);
    CHECK(f.mesh.positions.size() == 6);
    CHECK(f.mesh.normals.size() == 6);
    CHECK(f.mesh.uvs.size() == 6);
    CHECK(f.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {4, 1, 5}});
    CHECK(f.mesh.uvs[3] == Vec2{0.5f, 0.25f});
    CHECK(f.mesh.positions[4] == Vec3(0, 0, 0));
    CHECK(f.mesh.uvs[4] == Vec2{1, 0});
    CHECK(f.mesh.normals[5] == Vec3(0, 1, 0));
    // Forms mixed in one file: what is left out is 0.
    const MeshFile g = meshOfObj(std::string(kObjSquare) + "vt 0.5 0.5\nvn 0 0 2\nf 1//1 2//-1 3\nf 1/1 2/1 3/-1\n");
    CHECK(g.mesh.positions.size() == 6);
    CHECK(g.mesh.normals[0] == Vec3(0, 0, 2));
    CHECK(g.mesh.normals[2] == Vec3(0, 0, 0));
    CHECK(g.mesh.uvs[0] == Vec2{0, 0});
    CHECK(g.mesh.uvs[3] == Vec2{0.5f, 0.5f});
}

TEST_CASE("obj: groups") {
    const MeshFile f =
        meshOfObj(std::string(kObjSquare) + "o box\nusemtl red paint\nf 1 2 3\ng left  \nf 1 2 3 4\nf 2 3 4\n"
                                            "g empty\nusemtl blue\nf 1 3 4\no other\ns off\nmtllib a.mtl\nf 1 2 4\n");
    REQUIRE(f.groups.size() == 4);
    CHECK(f.groups[0].name == "box");
    CHECK(f.groups[0].material == "red paint");
    CHECK(f.groups[1].name == "left");
    CHECK(f.groups[1].material == "red paint");
    CHECK(f.groups[1].triangleCount == 1);
    CHECK(f.groups[1].quadCount == 1);
    CHECK(f.groups[2].name == "empty");
    CHECK(f.groups[2].material == "blue");
    CHECK(f.groups[2].firstTriangle == 2);
    CHECK(f.groups[3].name == "other");
    const MeshData part = extractGroup(f, f.groups[2]);
    CHECK(part.positions.size() == 3);
    CHECK(part.triangles == std::vector<Triangle>{{0, 1, 2}});
    CHECK(part.positions[1] == Vec3(1, 1, 0));
    CHECK(part.quads.empty());
}

TEST_CASE("obj: polygons of any shape keep their area") {
    // An L, both ways round, and a comb: concave. A hexagon: convex.
    const std::string_view l = "v 0 0 3\nv 2 0 3\nv 2 1 3\nv 1 1 3\nv 1 2 3\nv 0 2 3\n";
    CHECK(areaOf(meshOfObj(std::string(l) + "f 1 2 3 4 5 6\n").mesh) == doctest::Approx(3));
    CHECK(areaOf(meshOfObj(std::string(l) + "f 6 5 4 3 2 1\n").mesh) == doctest::Approx(3));
    std::string comb, face = "f";
    double expected = 0;
    for (int i = 0; i < 20; ++i) { // teeth of height 1 on a bar of height 1, tilted in space
        comb += "v " + std::to_string(i) + " " + std::to_string(i % 2 ? 1 : 2) + " " + std::to_string(i) + "\n";
        if (i > 0) expected += 1.5;
    }
    comb += "v 19 0 19\nv 0 0 0\n";
    for (int i = 22; i >= 1; --i) face += " " + std::to_string(i);
    const MeshFile f = meshOfObj(comb + face + "\n");
    CHECK(f.mesh.triangles.size() == 20);
    CHECK(areaOf(f.mesh) == doctest::Approx(expected * std::sqrt(2.0)));
    // Normals of all parts agree.
    for (const auto& t : f.mesh.triangles) {
        const auto& p = f.mesh.positions;
        CHECK(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z >= 0);
    }
    // Concave quads: an arrow, with the notch at each of its corners.
    for (int turn = 0; turn < 4; ++turn) {
        std::string arrow = "v 0 0 0\nv 2 -2 0\nv 1 0 0\nv 2 2 0\nf";
        for (int i = 0; i < 4; ++i) arrow += " " + std::to_string((i + turn) % 4 + 1);
        const MeshFile a = meshOfObj(arrow + "\n");
        CHECK(a.mesh.quads.size() == 1);
        CHECK(areaOf(a.mesh) == doctest::Approx(2));
    }
    std::string star; // crosses itself: any answer, but an answer
    for (int i = 0; i < 5; ++i)
        star +=
            "v " + std::to_string(std::cos(i * 0.8 * kPiD)) + " " + std::to_string(std::sin(i * 0.8 * kPiD)) + " 0\n";
    CHECK(meshOfObj(star + "f 1 2 3 4 5\n").mesh.triangles.size() == 3);
}

TEST_CASE("obj: faults are named with their line") {
    const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto has = [](const std::string& text, const std::string& part) {
        const std::string e = objError(text);
        INFO(e);
        CHECK(e.find(part) != std::string::npos);
    };
    has(v + "f 1 2 4\n", "`t.obj`: line 4: vertex 4 of only 3");
    has(v + "f 0 1 2\n", "line 4: vertex numbers start at 1");
    has(v + "f 1 2 -4\n", "line 4: vertex -4 of only 3 so far");
    has(v + "f 1/1 2 3\n", "line 4: texture vertex 1 of only 0");
    has(v + "f 1//2 2 3\n", "line 4: normal 2 of only 0");
    has(v + "f 1 2 3x\n", "line 4: `x` after a face corner");
    has(v + "f 1 2 a\n", "line 4: `a` is not a vertex number");
    has(v + "f 1 2 99999999999999999999\n", "line 4");
    has(v + "f 1 2 4294967298\n", "too large");
    has(v + "f\n", "line 4: a face without corners");
    has("v 0 0\n", "line 1: a number is missing: z");
    has("\n\nv 0 nan 0\n", "line 3: y is not finite");
    has("v 0 0 inf\n", "line 1: z is not finite");
    has("v 1e39 0 0\n", "line 1: x is not finite");
    has("v 1e999 0 0\n", "line 1: `1e999` is not a number that fits");
    has("v 0,5 0 0\n", "line 1: `0,5` is not a number");
    has("v 1 2 3 4 5 6 7 8\n", "line 1: too many numbers");
    has("vn 0 0 1 2\n", "line 1: `2` at the end of the statement");
    has("secret 3\n", "line 1: it is not a statement of polygon meshes");
    has("v 0 0 0\nverts 3\n", "line 2: `verts` is not a statement of polygon meshes");
    has("", "there is no mesh in it");
    has(v, "it has vertices but no faces");
    has(v + "l 1 2\np 1\nf 1 2\n", "no faces");
    CHECK(meshOfObj(v + "f 1 2\nf 1 2 3\n").ignoredFaces == 1);
}

TEST_CASE("obj: damaged files end in an error or a mesh that is in range") {
    const std::string good = std::string(kObjSquare) +
                             "v 0.5 0.5 2\nvt 0 0\nvt 1 1\nvn 0 0 1\no a\ng b\nusemtl c\n"
                             "f 1/1/1 2/2/1 3/1/1 4/2/1\nf -1 -2 \\\n -3\nf 1//1 2//1 5//1\nf 1 2 3 4 5\ns 1\n# end\n";
    Random random(1);
    int errors = 0;
    for (int i = 0; i < 10000; ++i) {
        std::string text = good;
        for (std::uint32_t k = 1 + random.bits() % 4; k > 0; --k) {
            if (text.empty()) text = " ";
            const std::size_t at = random.bits() % text.size();
            switch (random.bits() % 4) {
            case 0:
                text[at] = static_cast<char>(random.bits());
                break;
            case 1:
                text.resize(at + 1);
                break;
            case 2:
                text.erase(at, random.bits() % 9);
                break;
            default:
                text.insert(at, good.substr(random.bits() % good.size(), random.bits() % 12));
                break;
            }
        }
        try {
            const MeshFile f = meshOfObj(text);
            const std::size_t n = f.mesh.positions.size();
            for (const auto& t : f.mesh.triangles)
                for (std::uint32_t v : t) REQUIRE(v < n);
            for (const auto& q : f.mesh.quads)
                for (std::uint32_t v : q) REQUIRE(v < n);
            for (Vec3 p : f.mesh.positions) REQUIRE(isFinite(p));
            REQUIRE((f.mesh.uvs.empty() || f.mesh.uvs.size() == n));
            REQUIRE((f.mesh.normals.empty() || f.mesh.normals.size() == n));
        } catch (const IoError&) {
            ++errors;
        }
    }
    CHECK(errors > 1000);
    CHECK(errors < 10000);
}

TEST_CASE("obj: large polygons take no forever") {
    std::string text, face = "f";
    for (int i = 0; i < 3000; ++i) { // a zigzag: concave
        text += "v " + std::to_string(i) + " " + std::to_string(i % 2) + " 0\n";
        face += " " + std::to_string(i + 1);
    }
    const std::string concave = objError(text + "v 1500 900 0\n" + face + " 3001\n");
    CHECK(concave.find("line 3002: a concave polygon with more than 1024 corners") != std::string::npos);
    std::string circle, all = "f";
    for (int i = 0; i < 3000; ++i) {
        circle += "v " + std::to_string(1e3 * std::cos(i * 2 * kPiD / 3000)) + " " +
                  std::to_string(1e3 * std::sin(i * 2 * kPiD / 3000)) + " 0\n";
        all += " " + std::to_string(i + 1);
    }
    CHECK(meshOfObj(circle + all + "\n").mesh.triangles.size() == 2998);
}

TEST_CASE("obj: files") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.obj";
    std::ofstream(path) << kObjSquare << "f 1 2 3 4\n";
    CHECK(readObj(path).mesh.quads.size() == 1);
    CHECK(readMesh(path).mesh.quads.size() == 1);
    CHECK_THROWS_AS(readObj(folder / "absent.obj"), IoError);
}

TEST_CASE("obj: speed") {
    std::string text;
    constexpr int n = 200;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            text += "v " + std::to_string(i * 0.0123456) + " " + std::to_string(j * 0.0234567) + " 0.123456\n";
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i + 1;
            text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + n + 2) + " " +
                    std::to_string(a + n + 1) + "\n";
        }
    double best = 1e9;
    for (int k = 0; k < 5; ++k) {
        MeshFile f;
        best = std::min(best, test::cpuSecondsOf([&] { f = meshOfObj(text); }));
        REQUIRE(f.mesh.quads.size() == n * n);
    }
    const double speed = static_cast<double>(text.size()) / best;
    MESSAGE("OBJ read at " << speed * 1e-6 << " MB/s");
    // A tenth of what it does: sanitizers and busy machines must pass, quadratic time must not.
    CHECK(speed > 3e6);
}

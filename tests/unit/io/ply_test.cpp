#include "io/mesh_file.h"
#include "support/statistics.h"
#include "temporary_folder.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <doctest/doctest.h>
#include <limits>

using namespace abbe;
using test::Random;

namespace {

MeshFile meshOfPly(std::string_view bytes) { return parsePly(bytes, "t.ply"); }

std::string plyError(std::string_view bytes) {
    try {
        meshOfPly(bytes);
    } catch (const IoError& e) {
        return e.what();
    }
    return "";
}

using Triangle = std::array<std::uint32_t, 3>;
using QuadIndices = std::array<std::uint32_t, 4>;

// Writes numbers in a byte order, as a PLY body.
class Body {
  public:
    explicit Body(bool big) : big_(big) {}
    template <typename T> Body& add(T value) {
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), &value, sizeof(T));
        if (big_ == (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.end());
        text_.append(bytes.data(), bytes.size());
        return *this;
    }
    const std::string& str() const { return text_; }

  private:
    bool big_;
    std::string text_;
};

constexpr std::string_view kTextSquare =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\n"
    "property float y\nproperty float z\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n4 0 1 2 3\n3 0 1 2\n";

// Everything at once: doubles, normals, texture coordinates under odd names, extra properties and elements.
std::string rich(bool big) {
    std::string header = std::string("ply\r\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                         " 1.0\r\nobj_info nothing\r\nelement camera 2\r\nproperty list int float lens\r\n"
                         "property uchar id\r\nelement vertex 3\r\nproperty uchar red\r\nproperty double x\r\n"
                         "property double y\r\nproperty double z\r\nproperty list uchar short tags\r\n"
                         "property float nx\r\nproperty float ny\r\nproperty float nz\r\nproperty float s\r\n"
                         "property float t\r\nelement face 2\r\nproperty float quality\r\n"
                         "property list uint16 uint32 vertex_index\r\nproperty short flags\r\nelement edge 1\r\n"
                         "property int a\r\nend_header\r\n";
    Body b(big);
    b.add<std::int32_t>(2).add(1.f).add(2.f).add<std::uint8_t>(7);
    b.add<std::int32_t>(0).add<std::uint8_t>(8);
    for (int i = 0; i < 3; ++i) {
        b.add<std::uint8_t>(200).add(i == 1 ? 1.0 : 0.0).add(i == 2 ? 1.0 : 0.0).add(0.25);
        b.add<std::uint8_t>(static_cast<std::uint8_t>(i));
        for (int k = 0; k < i; ++k) b.add<std::int16_t>(-5);
        b.add(0.f).add(0.f).add(1.f).add(0.5f * static_cast<float>(i)).add(0.75f);
    }
    b.add(0.5f)
        .add<std::uint16_t>(3)
        .add<std::uint32_t>(0)
        .add<std::uint32_t>(1)
        .add<std::uint32_t>(2)
        .add<std::int16_t>(1);
    b.add(0.5f).add<std::uint16_t>(2).add<std::uint32_t>(0).add<std::uint32_t>(1).add<std::int16_t>(1);
    b.add<std::int32_t>(9);
    return header + b.str();
}

} // namespace

TEST_CASE("ply: text") {
    const MeshFile f = meshOfPly(kTextSquare);
    CHECK(f.mesh.positions.size() == 4);
    CHECK(f.mesh.positions[2] == Vec3(1, 1, 0.5f));
    CHECK(f.mesh.quads == std::vector<QuadIndices>{{0, 1, 2, 3}});
    CHECK(f.mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
    REQUIRE(f.groups.size() == 1);
    CHECK(f.groups[0].quadCount == 1);
    std::string noEnd(kTextSquare);
    noEnd.pop_back(); // the last line need not end
    CHECK(meshOfPly(noEnd).mesh.triangles.size() == 1);
}

TEST_CASE("ply: binary of both byte orders, with all that can be there") {
    for (bool big : {false, true}) {
        const MeshFile f = meshOfPly(rich(big));
        CHECK(f.mesh.positions == std::vector<Vec3>{{0, 0, 0.25f}, {1, 0, 0.25f}, {0, 1, 0.25f}});
        CHECK(f.mesh.normals == std::vector<Vec3>(3, Vec3(0, 0, 1)));
        CHECK(f.mesh.uvs == std::vector<Vec2>{{0, 0.75f}, {0.5f, 0.75f}, {1, 0.75f}});
        CHECK(f.mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
        CHECK(f.ignoredFaces == 1);
    }
}

TEST_CASE("ply: faces before vertices, and polygons") {
    const MeshFile f = meshOfPly("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
                                 "element vertex 6\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
                                 "6 0 1 2 3 4 5\n0 0 0 2 0 0 2 1 0 1 1 0 1 2 0 0 2 0\n");
    CHECK(f.mesh.triangles.size() == 4); // an L
}

TEST_CASE("ply: faults are named with their byte") {
    const auto has = [](std::string text, const std::string& from, const std::string& to, const std::string& part) {
        const std::size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        const std::string e = plyError(text.replace(at, from.size(), to));
        INFO(e);
        CHECK(e.find(part) != std::string::npos);
    };
    const std::string square(kTextSquare);
    const auto bytes = [&](const std::string& before) { return std::to_string(square.find(before)); };
    has(square, "ply", "plx", "it does not begin with `ply`");
    has(square, "format ascii 1.0\n", "", "the header states no format");
    has(square, "ascii", "binary_middle_endian", "unknown format `binary_middle_endian`");
    has(square, "vertex 4", "vertex four", "`four` is not a count");
    has(square, "vertex 4", "vertex -4", "`-4` is not a count");
    has(square, "vertex 4", "vertex 4000000000000", "more than the file holds");
    has(square, "vertex 4", "vertex 18446744073709551615", "more than the file holds");
    has(square, "face 2", "face 40", "more than the file holds");
    has(square, "face 2", "face 3", "the file ends too early");
    has(square, "face 2", "face 0", "there are no faces");
    has(square, "property float x\n", "", "the vertices have no x, y and z");
    has(square, "float x", "quad x", "unknown type `quad`");
    has(square, "property float x", "property float", "a property needs a type and a name");
    has(square, "uchar int", "float int", "the length of a list must be an integer");
    has(square, "vertex_indices", "corners", "the faces have no `vertex_indices`");
    has(square, "element face 2", "element vertex 2", "the element `vertex` comes twice");
    has(square, "element face 2\n", "", "there are no faces");
    has(square, "end_header\n", "", "unknown header line `0`");
    has(square, "comment", "commend", "unknown header line `commend`");
    has(square, "4 0 1 2 3", "4 0 1 2 4",
        "byte " + std::to_string(square.find("4 0 1 2 3") + 8) + ": vertex 4 of only 4");
    has(square, "4 0 1 2 3", "4 0 1 2 -1", "vertex -1 of only 4");
    has(square, "4 0 1 2 3", "4 0 1 2 1.5", "vertex 1.5 of only 4");
    has(square, "4 0 1 2 3", "900 0 1 2 3", "a list of 900 entries is more than the file holds");
    has(square, "0.5", "nan", "byte " + bytes("0.5") + ": `z` of vertex 2 is not finite");
    has(square, "0.5", "1e99", "`z` of vertex 2 is not finite");
    has(square, "0.5", "0.5x", "byte " + bytes("0.5") + ": this is not a number");
    CHECK(plyError("").find("the header does not end") != std::string::npos);
    CHECK(plyError("ply\nformat ascii 1.0\n").find("the header does not end") != std::string::npos);
}

TEST_CASE("ply: a file cut anywhere is an error, never a crash") {
    for (bool big : {false, true}) {
        const std::string whole = rich(big);
        for (std::size_t size = 0; size < whole.size(); ++size) CHECK_FALSE(plyError(whole.substr(0, size)).empty());
    }
}

TEST_CASE("ply: damaged files end in an error or a mesh that is in range") {
    const std::array<std::string, 3> good{std::string(kTextSquare), rich(false), rich(true)};
    Random random(1);
    int errors = 0;
    for (int i = 0; i < 10000; ++i) {
        std::string bytes = good[static_cast<std::size_t>(i % 3)];
        for (std::uint32_t k = 1 + random.bits() % 4; k > 0; --k) {
            const std::size_t at = random.bits() % bytes.size();
            switch (random.bits() % 4) {
            case 0:
                bytes[at] = static_cast<char>(random.bits());
                break;
            case 1:
                bytes[at] = static_cast<char>('0' + random.bits() % 10);
                break;
            case 2:
                bytes.erase(at, random.bits() % 5);
                break;
            default:
                bytes.insert(at, bytes.substr(random.bits() % bytes.size(), random.bits() % 5));
                break;
            }
            if (bytes.empty()) bytes = " ";
        }
        try {
            const MeshFile f = meshOfPly(bytes);
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

TEST_CASE("ply: files, told from OBJ by content") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.dat";
    std::ofstream(path, std::ios::binary) << rich(true);
    CHECK(readPly(path).mesh.triangles.size() == 1);
    CHECK(readMesh(path).mesh.triangles.size() == 1);
    CHECK_THROWS_AS(readPly(folder / "absent.ply"), IoError);
}

namespace {

void appendNumber(std::string& out, auto value, bool big) {
    std::array<char, sizeof value> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    if (big) std::ranges::reverse(bytes);
    out.append(bytes.data(), bytes.size());
}

// A strip of triangles, quads and pentagons, as this machine has numbers in memory or in the other byte order, which is
// read number by number. `faces`: their number. `corner`: the last vertex of the last face.
std::string stripPly(bool big, std::uint32_t faces, bool whole, float last = 1, std::uint32_t corner = 0) {
    Random random(7);
    const std::uint32_t points = faces + 5;
    std::string out = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\nelement vertex " +
                      std::to_string(points) + "\nproperty float x\nproperty float y\nproperty float z\n" +
                      (whole ? "property float nx\nproperty float ny\nproperty float nz\nproperty float s\n"
                               "property float t\n"
                             : "property float nx\n") +
                      "element face " + std::to_string(faces) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::uint32_t i = 0; i < points; ++i)
        for (int k = 0; k < (whole ? 8 : 4); ++k)
            appendNumber(out, i + 1 == points && k == 0 ? last : random.uniform(), big);
    for (std::uint32_t i = 0; i < faces; ++i) {
        const std::uint32_t n = i % 7 == 3 ? 2 : 3 + i % 3;
        out += static_cast<char>(n);
        for (std::uint32_t k = 0; k < n; ++k)
            appendNumber(out, i + 1 == faces && k + 1 == n && corner ? corner : i + k, big);
    }
    return out;
}

} // namespace

TEST_CASE("ply: what is read at once is what is read number by number") {
    for (const bool whole : {false, true}) {
        const MeshFile fast = meshOfPly(stripPly(false, 100, whole)), slow = meshOfPly(stripPly(true, 100, whole));
        CHECK(fast.mesh.positions == slow.mesh.positions);
        CHECK(fast.mesh.normals == slow.mesh.normals);
        CHECK(fast.mesh.uvs == slow.mesh.uvs);
        CHECK(fast.mesh.triangles == slow.mesh.triangles);
        CHECK(fast.mesh.quads == slow.mesh.quads);
        CHECK(fast.mesh.quads.size() > 20);
        CHECK(fast.mesh.triangles.size() > 80);
        CHECK(fast.ignoredFaces == slow.ignoredFaces);
        CHECK(fast.ignoredFaces == 14);
        CHECK(fast.groups.at(0).triangleCount == fast.mesh.triangles.size());
    }
}

TEST_CASE("ply: faults that are found at once have the messages of those that are found number by number") {
    const float infinite = std::numeric_limits<float>::infinity();
    for (const bool whole : {false, true}) {
        const std::string number = plyError(stripPly(false, 100, whole, infinite));
        CHECK(number.find("`x` of vertex 104 is not finite") != std::string::npos);
        for (const std::uint32_t corner : {105u, 0xffffffffu})
            CHECK(plyError(stripPly(false, 100, whole, 1, corner)).find("of only 105") != std::string::npos);
        std::string cut = stripPly(false, 100, whole);
        cut.resize(cut.size() - 1);
        CHECK(plyError(cut).find("the file ends too early") != std::string::npos);
    }
}

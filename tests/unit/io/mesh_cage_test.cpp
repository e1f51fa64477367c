#include "io/file.h"
#include "io/mesh_file.h"
#include "support/nightly.h"
#include "support/statistics.h"
#include "temporary_folder.h"

#include <doctest/doctest.h>

using namespace abbe;

namespace {

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
                                "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                "f 1/1 2/2 3/3 4/4\nf 2/1 5/2 6/3 3/4\n";

CageFile parse(const std::string& tags) { return parseObjCage(kSquare + tags, "t.obj"); }

std::string errorOf(const std::string& tags) {
    try {
        parse(tags);
    } catch (const IoError& e) {
        return e.what();
    }
    return "";
}

} // namespace

TEST_CASE("cage: polygons stay whole and texture vertices keep their own indices") {
    const CageFile file = parse("f 1 2 3 4 6\n");
    const SubdivisionCage& c = file.cage;
    CHECK(c.positions.size() == 6);
    CHECK(c.faceSizes == std::vector<std::uint32_t>{4, 4, 5});
    CHECK(c.corners == std::vector<std::uint32_t>{0, 1, 2, 3, 1, 4, 5, 2, 0, 1, 2, 3, 5});
    // Corners without a texture vertex share the one behind the last, (0, 0).
    CHECK(c.uvCorners == std::vector<std::uint32_t>{0, 1, 2, 3, 0, 1, 2, 3, 4, 4, 4, 4, 4});
    REQUIRE(c.uvs.size() == 5);
    CHECK(c.uvs[2] == Vec2{1, 1});
    CHECK(c.uvs[4] == Vec2{0, 0});
    CHECK(!file.statesBoundary);
    CHECK(parseObjCage("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "t.obj").cage.uvCorners.empty());
}

TEST_CASE("cage: tags") {
    const CageFile file =
        parse("t crease 3/2/0 1 2 5 3.5 0.5\nt crease 2/1/0 0 1 10 \nt corner 2/1/0 0 4 2\n"
              "t hole 1/0/0 1\nt interpolateboundary 1/0/0 2\nt facevaryinginterpolateboundary 1/0/0 3\n"
              "t creasemethod 0/0/1 chaikin\nt smoothtriangles 0/0/1 smooth\nt vertexedit 1/1/1 0 1.5 add\n");
    const SubdivisionCage& c = file.cage;
    REQUIRE(c.creases.size() == 3);
    CHECK(c.creases[0].a == 1);
    CHECK(c.creases[0].b == 2);
    CHECK(c.creases[0].sharpness == 3.5f);
    CHECK(c.creases[1].a == 2);
    CHECK(c.creases[1].b == 5);
    CHECK(c.creases[1].sharpness == 0.5f);
    CHECK(c.creases[2].sharpness == 10);
    REQUIRE(c.sharpCorners.size() == 2);
    CHECK(c.sharpCorners[1].vertex == 4);
    CHECK(c.sharpCorners[1].sharpness == 2);
    CHECK(c.holes == std::vector<std::uint32_t>{1});
    CHECK(c.boundary == SubdivisionCage::Boundary::edgeOnly);
    CHECK(c.faceVarying == SubdivisionCage::FaceVarying::cornersPlus2);
    CHECK(c.creasing == SubdivisionCage::Creasing::chaikin);
    CHECK(c.smoothTriangles);
    CHECK(file.statesBoundary);
    CHECK(file.statesFaceVarying);
    CHECK(file.statesCreasing);
    CHECK(file.ignoredTags == 1);
    CHECK(file.ignoredTag == "vertexedit");
    CHECK(parse("t interpolateboundary 1/0/0 1\n").cage.boundary == SubdivisionCage::Boundary::edgeAndCorner);
    CHECK(parse("t interpolateboundary 1/0/0 0\n").cage.boundary == SubdivisionCage::Boundary::none);
}

TEST_CASE("cage: damaged tags are named with their line") {
    const std::string at = "cannot read `t.obj`: line 13: ";
    CHECK(errorOf("t\n") == at + "a tag without a name");
    CHECK(errorOf("t crease 2/1 0 1 10\n") == at + "the counts of a tag are like `2/1/0`");
    CHECK(errorOf("t crease 2/1/0 0 1\n") == at + "a number is missing in a tag");
    CHECK(errorOf("t crease 2/1/0 0 x 3\n") == at + "`x` is not a whole number of a tag");
    CHECK(errorOf("t crease 2/1/0 0 1 3 4\n") == at + "more values in a tag than it counts");
    CHECK(errorOf("t crease 999999999999/1/0 0 1 3\n") == at + "a tag counts more values than its line holds");
    CHECK(errorOf("t crease 2/1/0 0 6 3\n") == at + "a crease names vertex 6, but there are 6 (from 0)");
    CHECK(errorOf("t crease 2/1/0 -1 0 3\n") == at + "a crease names vertex -1, but there are 6 (from 0)");
    CHECK(errorOf("t crease 2/0/0 0 1\n") == at + "a crease needs a sharpness");
    CHECK(errorOf("t corner 1/1/0 6 3\n") == at + "a corner names vertex 6, but there are 6 (from 0)");
    CHECK(errorOf("t hole 1/0/0 2\n") == at + "a hole names face 2, but there are 2 (from 0)");
    CHECK(errorOf("t interpolateboundary 1/0/0 3\n") == at + "`interpolateboundary` is 0, 1 or 2");
    CHECK(errorOf("t creasemethod 0/0/1 linear\n") == at + "`creasemethod` is `normal` or `chaikin`");
}

TEST_CASE("cage: tags are passed over in meshes, PLY files are read as cages") {
    CHECK(parseObj(std::string(kSquare) + "t crease 2/1/0 0 1 10\n", "t.obj").mesh.quads.size() == 2);
    const CageFile file = parsePlyCage("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                                       "property float z\nproperty float u\nproperty float v\nelement face 1\n"
                                       "property list uchar int vertex_indices\nend_header\n"
                                       "0 0 0 0 0\n1 0 0 1 0\n2 1 0 1 .5\n1 2 0 1 1\n0 1 0 0 1\n5 0 1 2 3 4\n",
                                       "t.ply");
    CHECK(file.cage.faceSizes == std::vector<std::uint32_t>{5});
    CHECK(file.cage.corners == std::vector<std::uint32_t>{0, 1, 2, 3, 4});
    CHECK(file.cage.uvCorners == file.cage.corners);
    CHECK(file.cage.uvs.size() == 5);
}

// Cages with tags, damaged at random: an error that names its line, or a cage whose indices are in range.

using namespace abbe;
using test::Random;

namespace {

int tries() { return test::nightly() ? 20'000 : 2000; }

const std::string kTagged = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0.5\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                            "g left\nf 1/1 2/2 3/3 4/4\ng right\nf 2/1 5/2 6/3 3/4\nf 1 2 5\n"
                            "t crease 3/2/0 1 2 5 3.5 0.5\nt crease 2/1/0 0 1 10\nt corner 2/1/0 0 4 2\n"
                            "t hole 1/0/0 1\nt interpolateboundary 1/0/0 2\nt facevaryinginterpolateboundary 1/0/0 3\n"
                            "t creasemethod 0/0/1 chaikin\nt smoothtriangles 0/0/1 smooth\n";

std::string damaged(const std::string& good, Random& random) {
    std::string text = good;
    for (std::uint32_t k = 1 + random.bits() % 4; k > 0; --k) {
        if (text.empty()) text = " ";
        const std::size_t at = random.bits() % text.size();
        switch (random.bits() % 5) {
        case 0:
            text[at] = static_cast<char>(random.bits());
            break;
        case 1:
            text[at] = static_cast<char>('0' + random.bits() % 10);
            break;
        case 2:
            text.resize(at + 1);
            break;
        case 3:
            text.erase(at, random.bits() % 9);
            break;
        default:
            text.insert(at, good.substr(random.bits() % good.size(), random.bits() % 12));
            break;
        }
    }
    return text;
}

// One assertion for each index would be millions.
bool inRange(const SubdivisionCage& c) {
    std::size_t corners = 0;
    for (const std::uint32_t size : c.faceSizes) corners += size;
    bool good = corners == c.corners.size() && (c.uvCorners.empty() || c.uvCorners.size() == corners);
    for (const std::uint32_t v : c.corners) good = good && v < c.positions.size();
    for (const std::uint32_t v : c.uvCorners) good = good && v < c.uvs.size();
    for (const Vec3& p : c.positions) good = good && isFinite(p);
    return good;
}

} // namespace

TEST_CASE("cage: random damage to a cage with tags ends in an error or a cage that is in range") {
    Random random(4);
    int errors = 0, good = 0, unnamed = 0;
    for (int i = 0; i < tries(); ++i) {
        const std::string text = damaged(kTagged, random);
        try {
            good += inRange(parseObjCage(text, "t.obj").cage);
        } catch (const IoError& e) {
            ++errors;
            unnamed += std::string_view(e.what()).find("t.obj") == std::string_view::npos;
        }
    }
    CHECK(good + errors == tries());
    CHECK(good > tries() / 10);
    CHECK(errors > tries() / 10);
    CHECK(unnamed == 0);
}

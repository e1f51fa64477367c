// Cages with tags, damaged at random: an error that names its line, or a cage whose indices are in range.
#include "io/cage_file.h"
#include "io/io_error.h"
#include "support/statistics.h"

#include <cstdlib>
#include <doctest/doctest.h>

using namespace abbe;
using test::Random;

namespace {

int tries() {
    const char* nightly = std::getenv("ABBE_NIGHTLY");
    return nightly && *nightly == '1' ? 20'000 : 2000;
}

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

// The limit surface against uniform refinement, and what must hold of its normals and of cages; no ray leaves a closed
// diced surface from inside.
#include "geometry/subdivision_surface.h"
#include "support/escapes.h"
#include "support/nightly.h"
#include "support/statistics.h"
#include "support/subdivision_cages.h"
#include "support/subdivision_reference.h"

#include <cstdlib>
#include <doctest/doctest.h>
#include <limits>

using namespace abbe;
using namespace abbe::test;

namespace {

constexpr std::uint64_t kPlentyOfMemory = 1ull << 33;

DicedSurface diceLevel(const SubdivisionCage& cage, double level) {
    REQUIRE(findFault(cage) == std::nullopt);
    const SubdivisionSurface surface(cage);
    return surface.dice(surface.plan({Dicing::Mode::level, level, {}}, kPlentyOfMemory));
}

void checkSound(const MeshData& m) {
    bool finite = true, inRange = true;
    for (const Vec3 p : m.positions) finite = finite && isFinite(p);
    for (const Vec3 n : m.normals) finite = finite && isFinite(n);
    for (const Vec2 t : m.uvs) finite = finite && isFinite(t.x) && isFinite(t.y);
    for (const auto& t : m.triangles)
        for (const auto v : t) inRange = inRange && v < m.positions.size();
    for (const auto& q : m.quads)
        for (const auto v : q) inRange = inRange && v < m.positions.size();
    CHECK(finite);
    CHECK(inRange);
    CHECK(m.normals.size() == m.positions.size());
}

} // namespace

TEST_CASE("subdivision: small cages agree with uniform refinement") {
    for (const auto& [name, cage, closed] : namedCages()) {
        CAPTURE(name);
        for (const int level : {2, 5}) {
            CAPTURE(level);
            const DicedSurface diced = diceLevel(cage, level);
            checkSound(diced.mesh);
            const Agreement a = compareWithReference(cage, diced.mesh, level, 7 - level);
            CHECK(a.vertices > 0);
            CHECK(a.distance < 1e-4);
            CHECK(a.angle < 0.5);
            CHECK(a.worstSmooth < 0.5);
            CHECK(a.uncompared < 0.7);
        }
    }
}

TEST_CASE("subdivision: closed cages dice into closed meshes at every rate") {
    for (const auto& [name, cage, closed] : namedCages()) {
        if (!closed) continue;
        CAPTURE(name);
        const SubdivisionSurface surface(cage);
        for (const int level : {0, 2, 4}) CHECK(openEdges(diceLevel(cage, level).mesh) == 0);
        // Every edge its own rate, and odd ones.
        for (const double length : {0.7, 0.21, 0.083})
            CHECK(openEdges(surface.dice(surface.plan({Dicing::Mode::length, length, {}}, kPlentyOfMemory)).mesh) == 0);
        const auto pixelSize = [](Vec3 p) { return 0.002 * static_cast<double>(length(p - Vec3(2, 1, 3))); };
        CHECK(openEdges(surface.dice(surface.plan({Dicing::Mode::pixels, 7, pixelSize}, kPlentyOfMemory)).mesh) == 0);
        Random random(7);
        DicingPlan plan = surface.plan({Dicing::Mode::level, 0, {}}, kPlentyOfMemory);
        for (int& rate : plan.edgeRates) rate = 1 + static_cast<int>(random.bits() % 13);
        const DicedSurface any = surface.dice(plan);
        checkSound(any.mesh);
        CHECK(openEdges(any.mesh) == 0);
    }
}

TEST_CASE("subdivision: normals about a vertex of any valence") {
    for (std::uint32_t valence = 3; valence <= 64; valence = valence < 12 ? valence + 1 : valence + 13) {
        CAPTURE(valence);
        const SubdivisionCage cage = domeCage(valence);
        const Agreement a = compareWithReference(cage, diceLevel(cage, 3).mesh, 3, 3);
        CHECK(a.distance < 1e-4);
        CHECK(a.worstSmooth < 0.5);
    }
}

TEST_CASE("subdivision: an infinitely creased cube is a cube") {
    const DicedSurface diced = diceLevel(creasedCube(10), 3);
    checkSound(diced.mesh);
    const MeshData& m = diced.mesh;
    CHECK(m.quads.size() == 6 * 64);
    for (std::size_t i = 0; i < m.quads.size(); ++i) {
        const std::size_t face = i / 64;
        Vec3 outward;
        (face / 2 == 0 ? outward.z : face / 2 == 1 ? outward.y : outward.x) = face % 2 ? 1.f : -1.f;
        for (const std::uint32_t v : m.quads[i]) {
            CHECK(length(m.normals[v] - outward) < 1e-3f);
            CHECK(dot(m.positions[v], outward) == doctest::Approx(1).epsilon(1e-6));
        }
    }
    // 8 corners and 12 edges of 7 points, each three or two times.
    CHECK(m.positions.size() == 8 * 3 + 12 * 7 * 2 + 6 * 49);
    CHECK(diced.seams.size() == 8 * 2 + 12);
}

TEST_CASE("subdivision: seams keep their sides apart and their positions together" * doctest::test_suite("input")) {
    const DicedSurface diced = diceLevel(seamedCube(), 3);
    const MeshData& m = diced.mesh;
    REQUIRE(m.uvs.size() == m.positions.size());
    CHECK(!diced.seams.empty());
    for (const DicedSeam& seam : diced.seams)
        for (std::uint32_t i = 0; i < seam.count; ++i) {
            CHECK(m.positions[seam.copy + i] == m.positions[seam.original + i]);
            CHECK(length(m.normals[seam.copy + i] - m.normals[seam.original + i]) < 1e-3f);
            CHECK(std::abs(m.uvs[seam.copy + i].x - m.uvs[seam.original + i].x) > 0.05f);
        }
    for (std::size_t i = 0; i < m.quads.size(); ++i) // every face stays in its own square
        for (const std::uint32_t v : m.quads[i]) CHECK(static_cast<std::size_t>(m.uvs[v].x + 0.02f) == i / 64);
}

TEST_CASE("subdivision: a sharp corner of a smooth boundary has a normal") {
    SubdivisionCage cage = gridCage(1);
    for (Vec3& p : cage.positions) p.z = 0;
    for (const auto boundary : {SubdivisionCage::Boundary::edgeOnly, SubdivisionCage::Boundary::edgeAndCorner}) {
        cage.boundary = boundary;
        const MeshData m = diceLevel(cage, 4).mesh;
        for (const Vec3 n : m.normals) CHECK(length(n - Vec3(0, 0, 1)) < 1e-3f);
    }
}

TEST_CASE("subdivision: far from the origin the normals stay") {
    SubdivisionCage cage = cubeCage();
    const MeshData here = diceLevel(cage, 4).mesh;
    for (Vec3& p : cage.positions) p = p + Vec3(1 << 14, -(1 << 14), 1 << 13); // exact
    const MeshData there = diceLevel(cage, 4).mesh;
    for (std::size_t i = 0; i < here.normals.size(); ++i) CHECK(here.normals[i] == there.normals[i]);
}

TEST_CASE("subdivision: a deformed cage is diced like the cage at rest" * doctest::test_suite("input")) {
    for (const auto& [name, cage, closed] : namedCages()) {
        CAPTURE(name);
        SubdivisionCage bent = cage;
        for (Vec3& p : bent.positions) p = {p.x + 0.3f * p.z * p.z, 1.7f * p.y + 5, p.z - 0.2f * p.x};
        const SubdivisionSurface surface(cage), other(bent);
        const DicingPlan plan = surface.plan({Dicing::Mode::length, 0.2, {}}, kPlentyOfMemory);
        const DicedSurface rest = surface.dice(plan), moved = surface.dice(plan, bent.positions);
        const DicedSurface expected = other.dice(plan);
        CHECK(moved.mesh.positions == expected.mesh.positions);
        CHECK(moved.mesh.normals == expected.mesh.normals);
        CHECK(moved.mesh.positions != rest.mesh.positions);
        CHECK(moved.mesh.triangles == rest.mesh.triangles);
        CHECK(moved.mesh.quads == rest.mesh.quads);
        CHECK(moved.mesh.uvs == rest.mesh.uvs);
        CHECK(moved.seams.size() == rest.seams.size());
        if (closed) CHECK(openEdges(moved.mesh) == 0);
    }
}

TEST_CASE("subdivision: edges are cut to the length asked for") {
    const SubdivisionSurface surface(gridCage(4));
    const auto longest = [](const MeshData& m) {
        float l = 0;
        for (const auto& q : m.quads)
            for (std::size_t i = 0; i < 4; ++i)
                l = std::max(l, length(m.positions[q[i]] - m.positions[q[(i + 1) % 4]]));
        return l;
    };
    for (const double wanted : {0.5, 0.1, 0.04}) {
        const float l = longest(surface.dice(surface.plan({Dicing::Mode::length, wanted, {}}, kPlentyOfMemory)).mesh);
        CHECK(l < 1.5 * wanted);
        CHECK(l > 0.5 * wanted);
    }
    // Pixels twice as large at x = 4 as at x = 0.
    const auto pixelSize = [](Vec3 p) { return 0.01 * (1 + static_cast<double>(p.x) / 4); };
    const MeshData m = surface.dice(surface.plan({Dicing::Mode::pixels, 4, pixelSize}, kPlentyOfMemory)).mesh;
    for (const auto& q : m.quads)
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 a = m.positions[q[i]], b = m.positions[q[(i + 1) % 4]];
            CHECK(static_cast<double>(length(b - a)) / pixelSize(a) < 4 * 1.6);
        }
    // The camera in the surface: pixels of no size at all.
    const auto plan = surface.plan({Dicing::Mode::pixels, 1, [](Vec3) { return 0.0; }}, 1 << 20);
    CHECK(plan.bytes <= 1 << 20);
}

TEST_CASE("subdivision: the budget lowers the rates before anything is made" * doctest::test_suite("input")) {
    const SubdivisionSurface surface(cubeCage());
    const DicingPlan free = surface.plan({Dicing::Mode::level, 6, {}}, kPlentyOfMemory);
    CHECK(free.coarser == 1);
    CHECK(free.triangles == 6 * 2 * 64 * 64);
    const DicingPlan tight = surface.plan({Dicing::Mode::level, 6, {}}, free.bytes / 5);
    CHECK(tight.coarser == 4);
    CHECK(tight.bytes <= free.bytes / 5);
    CHECK(surface.dice(tight).mesh.quads.size() == 6 * 16 * 16);
    const DicingPlan length = surface.plan({Dicing::Mode::length, 0.01, {}}, 1 << 20);
    CHECK(length.bytes <= 1 << 20);
    CHECK(length.bytes > (1 << 20) / 2);
    CHECK(length.coarser > 1.5);
    CHECK(surface.plan({Dicing::Mode::level, 6, {}}, 0).triangles == 12); // never less than the cage
}

TEST_CASE("subdivision: the estimate of triangles is near the truth") {
    for (const auto& [name, cage, closed] : namedCages()) {
        CAPTURE(name);
        const SubdivisionSurface surface(cage);
        const DicingPlan plan = surface.plan({Dicing::Mode::length, 0.03, {}}, kPlentyOfMemory);
        const MeshData m = surface.dice(plan).mesh;
        const double truth = static_cast<double>(m.triangles.size() + 2 * m.quads.size());
        CHECK(static_cast<double>(plan.triangles) > 0.9 * truth);
        CHECK(static_cast<double>(plan.triangles) < 1.6 * truth);
    }
}

TEST_CASE("subdivision: faults of cages are found and named" * doctest::test_suite("input")) {
    const auto fault = [](auto change) {
        SubdivisionCage cage = cubeCage();
        change(cage);
        return findFault(cage).value_or("");
    };
    CHECK(fault([](auto&) {}) == "");
    CHECK(fault([](auto& c) { c.corners[5] = 8; }) == "face 1 names vertex 8, but there are 8 points");
    CHECK(fault([](auto& c) { c.corners[5] = c.corners[4]; }) == "face 1 has vertex 4 twice");
    CHECK(fault([](auto& c) { c.faceSizes[2] = 2; }) == "face 2 has 2 corners");
    CHECK(fault([](auto& c) { c.faceSizes.pop_back(); }) == "24 corners are listed, 20 are needed");
    CHECK(fault([](auto& c) { c = SubdivisionCage(); }) == "the cage has no faces");
    CHECK(fault([](auto& c) { c.scheme = SubdivisionCage::Scheme::loop; }) ==
          "face 0 has 4 corners, but Loop subdivision needs triangles");
    CHECK(fault([](auto& c) { c.positions[3].y = std::numeric_limits<float>::quiet_NaN(); }) ==
          "vertex 3 is not finite or farther than 1e15 m");
    CHECK(fault([](auto& c) {
              c.creases = {{0, 7, 3}};
          }) == "a crease runs from vertex 0 to 7, which is no edge of a face");
    CHECK(fault([](auto& c) { c.creases = {{0, 1, -1}}; }) == "the crease from vertex 0 to 1 has a negative sharpness");
    CHECK(fault([](auto& c) {
              addFace(c, {1, 3, 2, 0}); // the first face from behind
              c.corners[0] = 0;
              c.creases = {{0, 2, 8}};
          }) == "a crease ends at vertex 0, where two faces lie back to back");
    CHECK(fault([](auto& c) { c.sharpCorners = {{8, 1}}; }) == "a corner names vertex 8, but there are 8 points");
    CHECK(fault([](auto& c) { c.holes = {6}; }) == "a hole names face 6, but there are 6 faces");
    CHECK(fault([](auto& c) { c.uvCorners = {0}; }) == "1 texture corners for 24 corners");
    CHECK(fault([](auto& c) { c.uvCorners.assign(24, 0); }) == "corner 0 names texture vertex 0, but there are 0");
}

TEST_CASE("subdivision: random cages, sound or not, do no harm" * doctest::test_suite("input")) {
    Random random(99);
    int sound = 0;
    const int count = test::nightly() ? 10'000 : 1000;
    for (int i = 0; i < count; ++i) {
        SubdivisionCage cage;
        const std::uint32_t vertices = 1 + random.bits() % 12;
        for (std::uint32_t v = 0; v < vertices; ++v)
            cage.positions.push_back({random.uniform(), random.uniform(), random.bits() % 8 ? random.uniform() : 0.f});
        if (random.bits() % 16 == 0) cage.positions[0].x = random.bits() % 2 ? kInfinity : 1e30f;
        if (random.bits() % 8 == 0) // all in one place
            for (Vec3& p : cage.positions) p = cage.positions[0];
        cage.scheme = static_cast<SubdivisionCage::Scheme>(random.bits() % 3);
        cage.boundary = static_cast<SubdivisionCage::Boundary>(random.bits() % 3);
        cage.creasing = static_cast<SubdivisionCage::Creasing>(random.bits() % 2);
        cage.faceVarying = static_cast<SubdivisionCage::FaceVarying>(random.bits() % 6);
        const bool bad = random.bits() % 4 == 0; // indices out of range
        for (std::uint32_t f = random.bits() % 10; f > 0; --f) {
            const std::uint32_t n = cage.scheme == SubdivisionCage::Scheme::loop ? 3 : 3 + random.bits() % 3;
            cage.faceSizes.push_back(n);
            std::vector<std::uint32_t> all;
            for (std::uint32_t v = 0; v < vertices; ++v) all.push_back(v);
            for (std::uint32_t k = 0; k < n; ++k) {
                const std::size_t pick = all.empty() ? 0 : random.bits() % all.size();
                cage.corners.push_back(bad || all.empty() ? random.bits() % (vertices + 2) : all[pick]);
                if (!all.empty()) all.erase(all.begin() + static_cast<std::ptrdiff_t>(pick));
            }
        }
        if (random.bits() % 2)
            for (std::size_t k = 0; k < cage.corners.size(); ++k) {
                cage.uvs.push_back({random.uniform(), random.uniform()});
                cage.uvCorners.push_back(random.bits() % static_cast<std::uint32_t>(k + 1));
            }
        if (random.bits() % 2 && cage.corners.size() > 1)
            cage.creases.push_back({cage.corners[0], cage.corners[1], 12 * random.uniform()});
        if (random.bits() % 2) cage.sharpCorners.push_back({random.bits() % (vertices + 1), 12 * random.uniform()});
        if (random.bits() % 4 == 0) cage.holes.push_back(random.bits() % 4);
        if (findFault(cage)) continue;
        ++sound;
        const SubdivisionSurface surface(cage);
        const DicedSurface diced = surface.dice(surface.plan({Dicing::Mode::level, 2, {}}, kPlentyOfMemory));
        checkSound(diced.mesh);
        checkSound(surface.dice(surface.plan({Dicing::Mode::length, 0.1, {}}, 1 << 20)).mesh);
    }
    CHECK(sound > count / 10);
}

TEST_CASE("subdivision: no ray leaves a closed surface") {
    const std::size_t rays = test::nightly() ? 1'000'000 : 20'000;
    for (const auto& [name, cage, closed] : namedCages()) {
        if (!closed) continue;
        CAPTURE(name);
        const SubdivisionSurface surface(cage);
        for (const double length : {0.3, 0.1, 0.03}) {
            const DicingPlan plan = surface.plan({Dicing::Mode::length, length, {}}, 1ull << 32);
            CHECK(escapes(surface.dice(plan).mesh, rays, 5) == 0);
        }
    }
}

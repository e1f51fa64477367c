// Displaced surfaces against closed forms, and that they stay closed.
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "geometry/subdivision_surface.h"
#include "support/analytic_textures.h"
#include "support/escapes.h"
#include "support/nightly.h"
#include "support/statistics.h"
#include "support/subdivision_cages.h"
#include "support/subdivision_reference.h"

#include <cstdlib>
#include <doctest/doctest.h>
#include <functional>

using namespace abbe;
using namespace abbe::test;

namespace {

using Space = Displacement::Space;
constexpr std::uint64_t kPlenty = 1ull << 33;

DicedSurface dice(const SubdivisionCage& cage, double level, const Displacement& d) {
    const SubdivisionSurface surface(cage);
    return surface.dice(surface.plan({Dicing::Mode::level, level, {}, {}}, kPlenty, &d), &d);
}

// A flat square 0 … n with texture coordinates that are its own times `scale`, turned and perhaps mirrored.
SubdivisionCage plane(std::uint32_t n, Vec2 uAxis, Vec2 vAxis) {
    SubdivisionCage c = gridCage(n);
    for (Vec3& p : c.positions) {
        p.z = 0;
        c.uvs.push_back({uAxis.x * p.x + uAxis.y * p.y, vAxis.x * p.x + vAxis.y * p.y});
    }
    c.uvCorners = c.corners;
    c.faceVarying = SubdivisionCage::FaceVarying::all;
    return c;
}

// The normal of a function of two parameters, by central differences.
Vec3d differenceNormal(const std::function<Vec3d(double, double)>& f, double x, double y) {
    const double h = 1e-5;
    return normalize(cross(f(x + h, y) - f(x - h, y), f(x, y + h) - f(x, y - h)));
}

// Texture coordinates of the cube: one square for each face, as different from its neighbours' as can be.
SubdivisionCage seamed(SubdivisionCage c) {
    c.uvs.clear();
    c.uvCorners.clear();
    std::uint32_t first = 0;
    for (std::size_t f = 0; f < c.faceSizes.size(); ++f) {
        for (std::uint32_t i = 0; i < c.faceSizes[f]; ++i) {
            const double phi = 2 * kPiD * i / c.faceSizes[f] + static_cast<double>(f);
            c.uvs.push_back(
                {static_cast<float>(std::cos(phi)), static_cast<float>(std::sin(phi) + 2.0 * static_cast<double>(f))});
            c.uvCorners.push_back(first + i);
        }
        first += c.faceSizes[f];
    }
    return c;
}

} // namespace

TEST_CASE("displacement: a plane becomes the height field, with its normals") {
    const UvWave wave;
    const Displacement d{Space::normal, 0.3, 0.25, &wave};
    const SubdivisionCage cage = plane(4, {0.8f, 0.3f}, {-0.2f, 1.1f});
    const auto height = [&](double x, double y) {
        return 0.3 *
               (std::sin(wave.fu * (0.8 * x + 0.3 * y) + 0.3) * std::cos(wave.fv * (-0.2 * x + 1.1 * y) - 0.2) - 0.25);
    };
    const auto surface = [&](double x, double y) { return Vec3d{x, y, height(x, y)}; };
    const MeshData m = dice(cage, 3, d).mesh;
    for (std::size_t i = 0; i < m.positions.size(); ++i) {
        const Vec3d p(m.positions[i]);
        CHECK(std::abs(p.z - height(p.x, p.y)) < 2e-6);
        CHECK(length(Vec3d(m.normals[i]) - differenceNormal(surface, p.x, p.y)) < 2e-5);
    }
}

TEST_CASE("displacement: vectors in tangent and object space, mirrored textures too") {
    const Constant offset({0.1f, 0.2f, 0.3f});
    const Vec2 axes[3][2] = {{{1, 0}, {0, 1}}, {{-1, 0}, {0, 1}}, {{0.6f, 0.8f}, {-0.8f, 0.6f}}};
    const Vec3 expected[3] = {{0.1f, 0.2f, 0.3f}, {-0.1f, 0.2f, 0.3f}, {0.06f - 0.16f, 0.08f + 0.12f, 0.3f}};
    for (int i = 0; i < 3; ++i) {
        const SubdivisionCage cage = plane(2, axes[i][0], axes[i][1]);
        const SubdivisionSurface surface(cage);
        const DicingPlan plan = surface.plan({Dicing::Mode::level, 2, {}, {}}, kPlenty);
        const MeshData still = surface.dice(plan).mesh;
        const Displacement tangent{Space::tangent, 1, 0, &offset}, object{Space::object, 2, 0, &offset};
        const MeshData a = surface.dice(plan, &tangent).mesh, b = surface.dice(plan, &object).mesh;
        for (std::size_t k = 0; k < still.positions.size(); ++k) {
            CHECK(length(a.positions[k] - still.positions[k] - expected[i]) < 2e-6f);
            CHECK(length(b.positions[k] - still.positions[k] - offset.value * 2.f) < 2e-6f);
            CHECK(length(a.normals[k] - still.normals[k]) < 1e-5f);
        }
    }
}

TEST_CASE("displacement: a vector wave over a plane, positions and normals") {
    const SpaceWave wave;
    for (const Space space : {Space::object, Space::tangent}) {
        const Displacement d{space, 0.1, 0.2, &wave};
        const SubdivisionSurface surface(plane(4, {1, 0}, {0, 1}));
        const DicingPlan plan = surface.plan({Dicing::Mode::level, 3, {}, {}}, kPlenty);
        const MeshData still = surface.dice(plan).mesh, moved = surface.dice(plan, &d).mesh;
        const auto at = [&](double x, double y) {
            return Vec3d{x, y, 0} + (SpaceWave::at({x, y, 0}, wave.f) - Vec3d{0.2, 0.2, 0.2}) * 0.1;
        };
        for (std::size_t i = 0; i < still.positions.size(); ++i) {
            const Vec3d p(still.positions[i]);
            CHECK(length(Vec3d(moved.positions[i]) - at(p.x, p.y)) < 2e-6);
            CHECK(length(Vec3d(moved.normals[i]) - differenceNormal(at, p.x, p.y)) < 2e-5);
        }
    }
}

// On a curved surface: the displaced normals against differences between the displaced neighbours, which shrink as the
// square of the dicing. Smooth cages only; all vertices, extraordinary ones included.
TEST_CASE("displacement: normals of displaced curved surfaces") {
    const SpaceWave space;
    const UvWave uv;
    SubdivisionCage grid = gridCage(3);
    for (const Vec3 p : grid.positions) grid.uvs.push_back({0.7f * p.x + 0.2f * p.y, 0.5f * p.y});
    grid.uvCorners = grid.corners;
    struct Case {
        std::string name;
        SubdivisionCage cage;
        Displacement d;
        double largest; // degrees, at level 6: about vertices of valence three curvature has no bound
    };
    const Case cases[] = {
        {"cube, along normals", cubeCage(), {Space::normal, 0.2, 0, &space}, 2},
        {"cube, object space", cubeCage(), {Space::object, 0.2, 0, &space}, 2},
        {"pyramid", pyramidCage(5), {Space::normal, 0.1, 0, &space}, 2},
        {"grid, image", grid, {Space::normal, 0.2, 0, &uv}, 2},
        {"grid, tangents", grid, {Space::tangent, 0.1, 0, &space}, 2},
    };
    for (const Case& c : cases) {
        CAPTURE(c.name);
        const MeshData m = dice(c.cage, 6, c.d).mesh;
        std::vector<Vec3d> sum(m.positions.size());
        std::vector<int> around(m.positions.size());
        const auto corner = [&](std::uint32_t v, std::uint32_t a, std::uint32_t b) {
            const Vec3d x = Vec3d(m.positions[a]) - Vec3d(m.positions[v]),
                        y = Vec3d(m.positions[b]) - Vec3d(m.positions[v]);
            sum[v] += cross(x, y) * (1 / (lengthSquared(x) * lengthSquared(y)));
            ++around[v];
        };
        for (const auto& q : m.quads)
            for (std::size_t i = 0; i < 4; ++i) corner(q[i], q[(i + 1) % 4], q[(i + 3) % 4]);
        for (const auto& t : m.triangles)
            for (std::size_t i = 0; i < 3; ++i) corner(t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
        double worst = 0;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            if (around[i] < 3) continue; // rims see one side only
            if (c.cage.uvs.size() && around[i] < 4) continue;
            worst = std::max(worst, std::acos(std::min(1.0, dot(normalize(sum[i]), Vec3d(m.normals[i])))) * 180 / kPiD);
        }
        CHECK(worst < c.largest);
    }
}

TEST_CASE("displacement: a constant moves an exact distance along the normal") {
    const Constant one({1, 1, 1});
    const Displacement d{Space::normal, 0.15, 0, &one};
    for (const SubdivisionCage& cage : {cubeCage(), seamedCube(), pyramidCage(5)}) {
        const SubdivisionSurface surface(cage);
        const DicingPlan plan = surface.plan({Dicing::Mode::level, 3, {}, {}}, kPlenty);
        const MeshData still = surface.dice(plan).mesh, moved = surface.dice(plan, &d).mesh;
        for (std::size_t i = 0; i < still.positions.size(); ++i) {
            CHECK(length(moved.positions[i] - still.positions[i] - still.normals[i] * 0.15f) < 2e-5f);
            CHECK(length(moved.normals[i] - still.normals[i]) < 2e-3f); // a parallel surface has parallel normals
        }
    }
}

TEST_CASE("displacement: closed cages stay closed, across seams and creases, at every rate") {
    const std::size_t rays = test::nightly() ? 1'000'000 : 6'000;
    const UvWave uv;
    const SpaceWave space;
    const Displacement kinds[] = {
        {Space::normal, 0.1, 0.3, &uv}, {Space::tangent, 0.06, 0, &space}, {Space::object, 0.06, 0, &space}};
    for (const auto& [name, cage, closed] : namedCages()) {
        if (!closed) continue;
        CAPTURE(name);
        const SubdivisionSurface surface(seamed(cage));
        for (const Displacement& d : kinds)
            for (const double length : {0.5, 0.21, 0.06}) {
                const DicedSurface diced =
                    surface.dice(surface.plan({Dicing::Mode::length, length, {}, {}}, kPlenty, &d), &d);
                CHECK(openEdges(diced.mesh) == 0);
                for (const DicedSeam& seam : diced.seams)
                    for (std::uint32_t i = 0; i < seam.count; ++i)
                        CHECK(diced.mesh.positions[seam.copy + i] == diced.mesh.positions[seam.original + i]);
                if (&d == kinds) CHECK(escapes(diced.mesh, rays, 5) == 0);
            }
    }
}

TEST_CASE("displacement: normals are continuous across a texture's seams and sharp across creases") {
    const SpaceWave wave; // the same on both sides
    const Displacement d{Space::normal, 0.2, 0, &wave};
    const DicedSurface smooth = dice(seamed(cubeCage()), 3, d);
    REQUIRE(!smooth.seams.empty());
    for (const DicedSeam& seam : smooth.seams)
        for (std::uint32_t i = 0; i < seam.count; ++i)
            CHECK(smooth.mesh.normals[seam.copy + i] == smooth.mesh.normals[seam.original + i]);
    const DicedSurface sharp = dice(seamed(creasedCube(10)), 3, d);
    for (const DicedSeam& seam : sharp.seams)
        for (std::uint32_t i = 0; i < seam.count; ++i)
            CHECK(dot(sharp.mesh.normals[seam.copy + i], sharp.mesh.normals[seam.original + i]) < 0.9f);
}

TEST_CASE("displacement: rates follow the displaced length and the budget" * doctest::test_suite("input")) {
    UvWave wave;
    wave.fu = 60;
    wave.fv = 0;
    const SubdivisionSurface surface(plane(1, {1, 0}, {0, 1}));
    const Displacement d{Space::normal, 0.05, 0, &wave};
    const Dicing fine{Dicing::Mode::length, 0.01, {}, {}};
    const auto flat = surface.plan(fine, kPlenty), rough = surface.plan(fine, kPlenty, &d);
    // The mean of √(1 + (0.05 · 60 · cos)² ) is 2.1.
    CHECK(static_cast<double>(rough.triangles) > 1.7 * static_cast<double>(flat.triangles));
    CHECK(rough.bytes == rough.triangles * SubdivisionSurface::kDisplacedBytesPerTriangle);
    const auto tight = surface.plan(fine, 1 << 20, &d);
    CHECK(tight.bytes <= 1 << 20);
    CHECK(tight.coarser > 1);
    Dicing placed = fine;
    placed.place = Transform::scale({2, 2, 2});
    CHECK(static_cast<double>(surface.plan(placed, kPlenty, &d).triangles) ==
          doctest::Approx(4 * static_cast<double>(rough.triangles)).epsilon(0.05));
}

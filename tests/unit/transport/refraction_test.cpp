// Single rays through glass: exit angles against Snell's law, and absorption against Beer and Lambert's, in double
// precision.
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "materials/dielectric.h"
#include "spectrum/curve.h"
#include "spectrum/dispersion.h"
#include "support/scene_test_paths.h"
#include "transport/surroundings.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// BK7 (Schott): B and C of Sellmeier's formula.
const SellmeierCurve kBk7(0, std::array{1.03961212, 0.231792344, 1.01046945},
                          std::array{0.00600069867, 0.0200179144, 103.560653});

// An equilateral prism along z with sides of 40 mm; the apex points up.
MeshData prismData(double turn) {
    const double c = std::cos(turn), s = std::sin(turn);
    const auto corner = [&](double x, double y, double z) { return Vec3(Vec3d{c * x - s * y, s * x + c * y, z}); };
    MeshData data;
    for (const double z : {-0.04, 0.04})
        for (const Vec2d p : {Vec2d{-0.02, -0.011547}, {0.02, -0.011547}, {0, 0.023094}})
            data.positions.push_back(corner(p.x, p.y, z));
    data.triangles = {{0, 2, 1}, {3, 4, 5}};
    data.quads = {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    return data;
}

// Snell's law as vectors [Glassner1989, ch. 4]; n against d, eta = index before over index after. Nothing: total.
std::optional<Vec3d> refractExactly(Vec3d d, Vec3d n, double eta) {
    const double c = -dot(d, n), k = 1 - eta * eta * (1 - c * c);
    if (k < 0) return std::nullopt;
    return d * eta + n * (eta * c - std::sqrt(k));
}

Vec3d faceNormal(const MeshData& data, std::array<std::uint32_t, 3> f) {
    const Vec3d a(data.positions[f[0]]), b(data.positions[f[1]]), c(data.positions[f[2]]);
    return normalize(cross(b - a, c - a));
}

double angleBetween(Vec3d a, Vec3d b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

// The direction of the transmitted ray at a hit, by the material's own sampling; uLobe 0.999… picks transmission.
std::optional<BsdfSample> transmitted(const SurfaceHit& hit, const Wavelengths& lambda, Vec3 direction, Arena& arena) {
    arena.reset();
    const Bsdf& bsdf = *hit.material->bsdf(hit, lambda, arena);
    return bsdf.sample(hit.shading.toLocal(-direction), kOneMinusEpsilon, {0.3f, 0.6f}, Transport::radiance);
}

} // namespace

TEST_CASE("a prism turns each wavelength by Snell's angles, within 1e-6 rad") {
    const auto glass = makeDielectric({.ior = &kBk7});
    Arena arena;
    double worst = 0;
    int rays = 0;
    for (const double turn : {0.0, 0.3, -0.5, 2.1}) {
        const Mesh prism(prismData(turn));
        EmbreeSceneBuilder builder;
        builder.addShape(prism, {glass.get(), nullptr});
        const auto world = builder.build();
        // Onto the middle of the left face, across it, and leave by the right one (faces 2 0 3 5 and 1 2 5 4).
        const Vec3d in = faceNormal(prism.data(), {2, 0, 3}), out = faceNormal(prism.data(), {1, 2, 5});
        const Vec3d along{0, 0, 1}, tangent = normalize(cross(in, along));
        const Vec3d target = (Vec3d(prism.data().positions[0]) + Vec3d(prism.data().positions[5])) / 2;
        for (const double incidence : {0.85, 0.7, 0.95})
            for (const double lean : {0.0, 0.06})
                for (const float nm : {361.f, 435.8f, 546.1f, 587.6f, 656.3f, 780.f}) {
                    const Wavelengths lambda = Wavelengths::single(nm);
                    // Towards the base, as light passes a prism.
                    Vec3d d = in * -std::cos(incidence) + tangent * std::sin(incidence);
                    if (dot(d, Vec3d(prism.data().positions[2]) - target) < 0)
                        d = in * -std::cos(incidence) - tangent * std::sin(incidence);
                    d = normalize(d + along * lean);
                    Ray ray{Vec3(target - d * 0.1), normalize(Vec3(d))};
                    const double n = kBk7.at(nm);
                    const auto inside = refractExactly(normalize(Vec3d(ray.direction)), in, 1 / n);
                    REQUIRE(inside);
                    const auto expected = refractExactly(*inside, -out, n);
                    if (!expected) continue; // total reflection at the second face
                    bool whole = true;
                    for (int face = 0; face < 2 && whole; ++face) {
                        SurfaceHit hit;
                        REQUIRE(world->intersect(ray, hit));
                        const auto s = transmitted(hit, lambda, ray.direction, arena);
                        REQUIRE(s);
                        CHECK(s->lobe.has(Lobe::transmission));
                        CHECK(s->eta == doctest::Approx(face == 0 ? n : 1 / n).epsilon(1e-6));
                        if (face == 1) whole = std::abs(dot(Vec3d(hit.ng), out)) > 0.999999;
                        const Vec3 w = hit.shading.toWorld(s->wi);
                        ray = {spawnOrigin(hit, w), w};
                    }
                    if (!whole) continue; // left by the base
                    ++rays;
                    const double error = angleBetween(Vec3d(ray.direction), *expected);
                    worst = std::max(worst, error);
                    CHECK_UNARY(error < 1e-6);
                    SurfaceHit none;
                    CHECK_FALSE(world->intersect(ray, none));
                }
    }
    CHECK(rays > 60);
    MESSAGE("largest error " << worst << " rad over " << rays << " rays");
}

TEST_CASE("of eight wavelengths the hero alone takes its own direction, and says that the others would not") {
    const auto glass = makeDielectric({.ior = &kBk7});
    Arena arena;
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.shading = Frame::fromNormal(hit.ng);
    hit.material = glass.get();
    for (const float u : {0.1f, 0.5f, 0.9f}) {
        const Wavelengths lambda = Wavelengths::sample(u);
        const Vec3 d = normalize(Vec3{0.6f, 0.2f, -1});
        const auto s = transmitted(hit, lambda, d, arena);
        REQUIRE(s);
        CHECK(s->lobe.has(Lobe::dispersive));
        const auto expected =
            refractExactly(normalize(Vec3d(d)), {0, 0, 1}, 1 / kBk7.at(static_cast<double>(lambda.nm[0])));
        CHECK(angleBetween(Vec3d(hit.shading.toWorld(s->wi)), *expected) < 1e-6);
    }
}

TEST_CASE("absorption in every lane is exp(-σ d)") {
    // Matter of index 1 absorbs and does nothing else, so that a path is a single straight ray.
    const auto scene = TestScene::parse(R"(scene 1
film { size 1 1 }
camera { from 0 0 5; look-at 0 0 0 }
light sky { radiance 2 }
material ink dielectric { ior 1; absorption table 400 0.1  500 3  650 0.5  700 1.5 }
shape mesh { material ink
    points { - -9 -9 -0.5; - 9 -9 -0.5; - 9 9 -0.5; - -9 9 -0.5; - -9 -9 0.5; - 9 -9 0.5; - 9 9 0.5; - -9 9 0.5 }
    faces { - 3 2 1 0; - 4 5 6 7; - 0 1 5 4; - 1 2 6 5; - 2 3 7 6; - 3 0 4 7 } }
shape sphere { center 0 0 -3; radius 1; material dielectric { ior 1; absorption 0.25 } }
)");
    REQUIRE(scene.report() == "");
    const Curve* ink = scene.scene().materials.front()->absorption();
    REQUIRE(ink != nullptr);
    const LightSampler lights(scene.scene().lights);
    const PathContext context{scene.scene(), lights, {}, true};
    const auto check = [&]<EffectBits E>(Vec3 origin, Vec3 direction, double inInk, double inSphere) {
        for (const float u : {0.05f, 0.4f, 0.77f}) {
            const Wavelengths lambda = Wavelengths::sample(u);
            Sampler sampler;
            sampler.startPixel(1, Technique::Numbers::sobol, true);
            sampler.start(0);
            Arena arena;
            PathCounters counters;
            auto media = PathWalk<E>::makeMedia(scene.scene());
            // The eye is the origin of render space.
            const Ray ray{origin - Vec3{0, 0, 5}, normalize(direction)};
            CameraPath<E> path(context, sampler, arena, counters, media);
            if constexpr (PathWalk<E>::kInterfaces) path.walk().startIn(surroundingsAt(scene.scene(), ray.origin, 0));
            const Spectrum seen = path.radiance(ray, lambda, 1e9f); // no roulette
            for (int lane = 0; lane < kLanes; ++lane) {
                const double sigma = ink->at(static_cast<double>(lambda.nm[lane]));
                CHECK(seen[lane] == doctest::Approx(2 * std::exp(-sigma * inInk - 0.25 * inSphere)).epsilon(1e-5));
            }
        }
    };
    constexpr EffectBits absorption = static_cast<EffectBits>(Effect::absorption), all = kLoopEffects.bits();
    const auto both = [&](Vec3 origin, Vec3 direction, double inInk, double inSphere) {
        check.operator()<absorption>(origin, direction, inInk, inSphere);
        check.operator()<all>(origin, direction, inInk, inSphere);
    };
    both({0, 0, 5}, {0, 0, -1}, 1, 2);        // slab and sphere, one after the other
    both({3, 0, 5}, {0, 0, -1}, 1, 0);        // slab alone
    both({3, 0, 5}, {0, 0.75f, -1}, 1.25, 0); // at an angle
    both({0, 0, 0.25f}, {0, 0, 1}, 0.25, 0);  // the eye inside
    both({0, 0, 0.25f}, {0, 0, -1}, 0.75, 2); // and something behind
    both({0, 0, -3}, {1, 0, 0}, 0, 1);        // inside the sphere
    both({20, 0, 5}, {0, 0, -1}, 0, 0);       // past both
}

} // namespace abbe::test

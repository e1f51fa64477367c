// One medium as a homogeneous one, as voxels and by noise; and one whose bounds are wrong on purpose.
#include "media/grid_medium.h"
#include "support/made_grids.h"
#include "support/media.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kCamera = "scene 1\nfilm { size 16 16; filter box 0.5 }\n"
                                "camera { from 0.7 1.1 4; look-at 0 0 0; fov 36 deg }\n";
constexpr const char* kSky = "light sky { radiance 1 }\n";
constexpr const char* kLit =
    "light sky { radiance 0.3 }\n"
    "shape sphere { center -0.6 2.2 0.8; radius 0.5; emission 6; material diffuse { reflectance 0 } }\n";

// Density 1 + 0.8 sin 4x in the world's cube from -1 to 1, whose bound is said to be `factor` times what it is.
class Waves final : public OpticalMedium {
  public:
    Waves(MediumOptics optics, float factor, Vec3d origin)
        : OpticalMedium(std::move(optics)), factor_(factor), origin_(origin) {}

    Bounds3 bounds() const override { return {Vec3{-1, -1, -1} - origin_, Vec3{1, 1, 1} - origin_}; }
    MediumWalk* walk(const Ray& render, float tMax, WalkSpace& space) const noexcept override {
        const Ray ray{render.origin + origin_, render.direction};
        float near = 0, far = tMax;
        for (int a = 0; a < 3; ++a) {
            if (ray.direction[a] == 0 && std::abs(ray.origin[a]) > 1) return nullptr;
            if (ray.direction[a] == 0) continue;
            const float t0 = (-1 - ray.origin[a]) / ray.direction[a], t1 = (1 - ray.origin[a]) / ray.direction[a];
            near = std::max(near, std::min(t0, t1));
            far = std::min(far, std::max(t0, t1));
        }
        return near < far ? space.make<Walk>(ray, near, far, factor_) : nullptr;
    }

  private:
    class Walk final : public MediumWalk {
      public:
        Walk(const Ray& ray, float near, float far, float factor)
            : ray_(ray), near_(near), far_(far), factor_(factor) {}
        bool next(MediumSegment& s) noexcept override {
            if (done_) return false;
            done_ = true;
            s = {near_, far_, 0.2f, std::min(1.f, 1.8f * factor_), 1.8f * factor_};
            return true;
        }
        float density(float t) noexcept override {
            return 1 + 0.8f * std::sin(4 * (ray_.origin.x + t * ray_.direction.x));
        }

      private:
        Ray ray_;
        float near_, far_, factor_;
        bool done_ = false;
    };

    float factor_;
    Vec3 origin_; // of render space
};

TestImage renderWaves(const std::string& lights, const Curve& extinction, const Curve& albedo, float factor,
                      std::uint32_t samples, std::uint64_t seed) {
    // Collisions of what stands there first depend on wavelength or do not, as those of its stand-in.
    TestScene scene = TestScene::parse(kCamera + lights + "volume atmosphere { extinction " +
                                       (extinction.isConstant() ? "1" : "table 400 1 700 2") + " per-m }\n");
    scene.standIn(std::make_unique<Waves>(opticsOf(extinction, albedo, 0.5), factor, scene.scene().origin));
    return render(scene, samples, seed);
}

} // namespace

TEST_CASE("the same box of fog as a homogeneous medium, by noise without contrast, and as voxels") {
    const std::string optical = "extinction 1.5 per-m; albedo 0.9; phase henyey-greenstein 0.5";
    const std::string world = std::string(kCamera) + kLit;
    const std::string noise = world + "volume noise { size 2 2 2; contrast 0; " + optical + " }\n";
    const std::uint32_t samples = nightly() ? 2048 : 512;
    const double resolution = nightly() ? 0.004 : 0.008;
    const TestImage filled =
        render(TestScene::parse(world + "shape box { size 2 2 2; material boundary; interior homogeneous { " + optical +
                                " } }\n"),
               samples, 1);
    const TestImage byNoise = render(TestScene::parse(noise), samples, 2);
    checkSame(compareImages(filled.film, byNoise.film), resolution);
    // A pattern that hardly shows, with bricks of its own: 1e-4 thinner in places.
    const TestImage shown =
        render(TestScene::parse(world + "volume noise { size 2 2 2; scale 0.4; contrast 0.0001; " + optical + " }\n"),
               samples, 4);
    checkSame(compareImages(filled.film, shown.film), resolution);

    // Voxels of 1/32 m; the outermost ones reach half of their size beyond the faces.
    std::vector<Voxel> voxels;
    for (int x = 0; x < 64; ++x)
        for (int y = 0; y < 64; ++y)
            for (int z = 0; z < 64; ++z) voxels.push_back({{x, y, z}, 1});
    GridFacts facts;
    facts.name = "density";
    facts.indexToWorld = Transform::scale({1 / 32.0, 1 / 32.0, 1 / 32.0})
                             .then(Transform::translate({0.5 / 32 - 1, 0.5 / 32 - 1, 0.5 / 32 - 1}));
    TestScene scene = TestScene::parse(noise);
    const ConstantCurve extinction(1.5), albedo(0.9);
    scene.standIn(std::make_unique<GridMedium>(opticsOf(extinction, albedo, 0.5), makeVoxelGrid(voxels, facts), 1.0,
                                               Transform::translate(-scene.scene().origin)));
    const TestImage grid = render(scene, samples, 3);
    checkSame(compareImages(filled.film, grid.film), resolution);
    checkSame(compareImages(byNoise.film, grid.film), resolution);
}

TEST_CASE("bounds that are too low bias nothing, and are counted; nor do bounds that are too high") {
    const ConstantCurve extinction(0.5), white(1), grey(0.7);
    for (const float factor : {0.5f, 1.f, 2.f, 8.f}) {
        if (!nightly() && factor != 0.5f && factor != 8) continue;
        INFO(factor);
        const TestImage furnace = renderWaves(kSky, extinction, white, factor, factor < 1 ? 8192 : 2048, 5);
        checkSame(compareExpected(furnace.film, [](int, int) { return 1.0; }), 0.006);
        CHECK(furnace.statistics.dropped == std::array<std::uint64_t, 3>{});
        const DensityExcess& excess = furnace.statistics.excess;
        if (factor < 1) {
            CHECK(excess.above > excess.lookups / 4);
            CHECK(excess.most == doctest::Approx(2).epsilon(0.01));
        } else {
            CHECK(excess.above == 0);
        }
    }
    const TestImage right = renderWaves(kLit, extinction, grey, 1, 4096, 6);
    for (const float factor : {0.5f, 2.f, 8.f})
        if (nightly() || factor != 2)
            checkSame(compareImages(renderWaves(kLit, extinction, grey, factor, 4096, 7).film, right.film), 0.006);
    // Where it depends on wavelength, and one that is hardly scattered in part of the spectrum.
    const SlopeCurve chromatic(0.9, 0.2), coloured(0.05, 0.95);
    const TestImage even = renderWaves(kLit, chromatic, coloured, 1, 4096, 8);
    const TestImage low = renderWaves(kLit, chromatic, coloured, 0.5f, 4096, 9);
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareImages(low.film, even.film, channel), 0.01);
}

TEST_CASE("white fog by noise in white surroundings cannot be seen") {
    for (const char* pattern : {"gradient; softness 0.1", "billow; octaves 3; edge 0.4", "cellular; warp 0.5"}) {
        const TestImage image = render(
            TestScene::parse(std::string(kCamera) + kSky + "volume noise { size 2 2 2; scale 0.5; pattern " + pattern +
                             "; extinction 4 per-m; phase henyey-greenstein 0.6; transform { rotate y 20 deg } }\n"),
            1024);
        INFO(std::string(pattern));
        checkSame(compareExpected(image.film, [](int, int) { return 1.0; }), 0.006);
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
        CHECK(image.statistics.excess.above < image.statistics.excess.lookups / 100);
    }
    const TestImage inside =
        render(TestScene::parse(std::string(kCamera) + kSky +
                                "medium smoke noise { scale 0.4; extinction 3 per-m; phase henyey-greenstein 0.6 }\n"
                                "shape sphere { radius 1; material boundary; interior smoke }\n"),
               1024);
    checkSame(compareExpected(inside.film, [](int, int) { return 1.0; }), 0.006);
    CHECK(inside.statistics.excess.above == 0);
}

TEST_CASE("an atmosphere is its medium everywhere") {
    const std::string world = std::string(kCamera) + kLit + "shape plane { center 0 -1 0; material diffuse }\n";
    const TestImage placed = render(TestScene::parse(world + "medium haze homogeneous { extinction 0.1 per-m; "
                                                             "albedo 0.8 }\natmosphere haze\n"),
                                    1024, 1);
    const TestImage volume =
        render(TestScene::parse(world + "volume atmosphere { extinction 0.1 per-m; albedo 0.8 }\n"), 1024, 2);
    checkSame(compareImages(placed.film, volume.film), 0.01);
}

} // namespace abbe::test

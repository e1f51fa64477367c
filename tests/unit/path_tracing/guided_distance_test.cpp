// Distances in media by a guide, in fog whose transmittance is known.
#include "path_tracing/guided_distance.h"
#include "support/scene_test_paths.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr EffectBits kAll = kLoopEffects.bits();
constexpr double kExtinction = 0.3, kFrom = 2, kTo = 2.5, kWall = 4; // 1/m, and m along the ray

// Of media that give off much between two planes of z, as seen along the ray, and little elsewhere. What surfaces do is
// in between.
RadianceCache beamBetween(float from, float to) {
    constexpr std::size_t kPlaces = 64;
    std::vector<SpaceTree::Place> places;
    for (std::uint32_t i = 0; i < kPlaces; ++i) {
        const float z = (static_cast<float>(i) + 0.5f) * static_cast<float>(kWall) / kPlaces;
        places.push_back({{0, 0, z}, kInMedium, i});
    }
    const SpaceTree tree(places, 1);
    std::vector<float> radiance(tree.leaves(), 0.2f);
    for (std::size_t leaf = 0; leaf < tree.leaves(); ++leaf)
        for (const SpaceTree::Place& at : tree.members(places, leaf))
            radiance[leaf] = at.p.z > from && at.p.z < to ? 1.f : 0.02f;
    return {tree, radiance};
}

struct Found {
    double beam = 0, through = 0; // weights of paths that are scattered in the beam and that reach the wall
    double inBeam = 0;            // share of the paths that are scattered there
};

} // namespace

// Weights and probabilities are each other's inverse: a weight that is a hundredth too large shows at once.
TEST_CASE("distances by a guide are weighed so that fog has its own transmittance, to two thousandths") {
    const auto scene = TestScene::parse("scene 1\ncamera { from 0 0 0; look-at 0 0 1 }\nlight sky { radiance 1 }\n"
                                        "material wall diffuse { reflectance 0.5 }\n"
                                        "shape wall quad { points -1 -1 4  1 -1 4  1 1 4  -1 1 4; material wall }\n"
                                        "volume atmosphere { extinction 0.3 per-m; albedo 1 }\n");
    REQUIRE(scene.report() == "");
    const LightSampler lights(scene.scene().lights);
    const PathContext context{scene.scene(), lights, {}, true};
    auto media = PathWalk<kAll>::makeMedia(scene.scene());
    const Vec3 eye = Vec3(Vec3d(0, 0, 0) - scene.scene().origin);
    const Ray ray{eye, {0, 0, 1}};
    SurfaceHit wall;
    REQUIRE(scene.scene().intersector->intersect(ray, wall));
    const RadianceCache cache = beamBetween(eye.z + static_cast<float>(kFrom), eye.z + static_cast<float>(kTo));
    class Unheard final : public EmissionListener {
        void emits(const MediumEmission&, float, const Spectrum&, const Spectrum&, const Spectrum&) override {}
    } unheard;
    Sampler sampler;
    Arena arena;
    PathCounters counters;
    Found found;
    constexpr int kPaths = 4'000'000;
    for (int i = 0; i < kPaths; ++i) {
        PathWalk<kAll> walk(context, sampler, arena, counters, media);
        walk.start(Wavelengths::single(550), 0);
        RandomStream random(static_cast<std::uint64_t>(i));
        const MediaLeg leg{ray, &wall, 0, random};
        const MediumCollision end = GuidedDistance<kAll>(walk, cache, leg).choose(unheard);
        const auto weight = static_cast<double>(mean(walk.path.beta) / mean(walk.path.densities.unidirectional));
        const bool inBeam = end.medium && end.t > static_cast<float>(kFrom) && end.t < static_cast<float>(kTo);
        (inBeam ? found.beam : found.through) += !end.medium || inBeam ? weight / kPaths : 0;
        found.inBeam += inBeam ? 1.0 / kPaths : 0;
    }
    const double beam = std::exp(-kExtinction * kFrom) - std::exp(-kExtinction * kTo);
    const double through = std::exp(-kExtinction * kWall);
    CHECK(std::abs(found.through / through - 1) < 0.002);
    CHECK(std::abs(found.beam / beam - 1) < 0.005);
    CHECK(found.inBeam > 1.8 * beam); // four times the ways, half of the choice by chance
    MESSAGE("through " << found.through << " of " << through << ", beam " << found.beam << " of " << beam << ", found "
                       << found.inBeam);
}

} // namespace abbe::test

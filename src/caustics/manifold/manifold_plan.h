// How specular manifold sampling takes part in a render: the plan, and what its pilot found.
#pragma once

#include "caustics/shared/chain_signature.h"
#include "render/light.h"
#include "render/shape.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

// Chains that are followed: those of one to kLongestManifoldChain events, numbered.
struct ManifoldKinds {
    static constexpr std::size_t kCount = 14; // 2 + 4 + 8

    // The shorter ones first, reflection before transmission. Requires 0 < length() <= kLongestManifoldChain.
    static std::size_t indexOf(const ChainSignature& chain) {
        std::size_t number = 1;
        for (int i = 0; i < chain.length(); ++i) number = 2 * number + static_cast<std::size_t>(chain[i]);
        return number - 2;
    }
    // Requires index < kCount.
    static ChainSignature ofIndex(std::size_t index) {
        const std::size_t number = index + 2;
        ChainSignature chain;
        for (int i = static_cast<int>(std::bit_width(number)) - 2; i >= 0; --i)
            chain.add(chainEvent((number >> i) & 1));
        return chain;
    }
};

// A shape that chains may start at, seen from the receiver. Render space, m.
struct SpecularCaster {
    const Shape* shape = nullptr;
    Vec3 centre; // of a ball around the shape: first directions are drawn towards it
    float radius = 0;
    // How often each kind of chain is tried, relative to the others, by ManifoldKinds::indexOf(). 0: never, and such
    // chains are not covered: the path tracer keeps them.
    std::array<float, ManifoldKinds::kCount> weights{};
};

// Which caustics are found by specular manifold sampling. Frozen before light is gathered: it says which light the path
// tracer leaves out.
struct ManifoldPlan {
    struct SampledLight {
        const Light* light = nullptr;
        float weight = 1; // > 0: how often it is sampled, relative to the others
        // sr: where the light's image is larger than this, it is left to others: to merging or to the path tracer,
        // whose rays find it soon enough. The image of the whole light is meant, magnified as at the point of it that a
        // chain leads to. Next to caustics it has no bound, and estimates of it would have none either.
        float largestImage = 0.5f;
    };

    std::vector<SpecularCaster> casters; // those of casterCandidates() that are wanted
    std::vector<SampledLight> lights;    // with Light::paths() other than none
    // How many estimates a vertex takes; their mean counts. Each has its own point of the light: where that decides
    // how much light there is, as near caustics, this is worth more than as many paths from the camera.
    std::uint32_t estimates = 1; // > 0
    // Solutions of which a trial in this many would find one are given up. Trials cost as much as there are solutions,
    // in the mean, however rare they are; the cap only keeps a single one from taking seconds.
    std::uint32_t maxTrials = 100'000;
};

// What was found out about caustics behind glass and in mirrors before a render, for people to read. Of manifold
// sampling. It depends on the scene, the frame and the seed alone.
struct ManifoldFindings {
    static constexpr std::size_t kObstacles = 4;

    bool measured = false; // a pilot has run: whether the numbers below mean anything
    bool used = false;
    bool leftToMerging = false; // which serves all these lights; the pilot found too few chains to trust them
    std::uint64_t chains = 0;   // that the pilot found
    // Of a sample of every pixel, in the mean over pixels: relative second moment of the light that chains of polished
    // interfaces bring to what is seen by way of others, as chance and as manifold sampling find it; relative variance
    // of everything else; and what all of that comes to in efficiency.
    double before = 0, after = 0, rest = 0, gain = 1;
    std::uint32_t estimates = 1; // of which a vertex takes the mean: as many as serve efficiency best
    std::uint64_t rays = 0;      // that it took to find out
    // Polished shapes over which chains cannot be followed, with the reason: what they focus is left to chance where it
    // is seen by way of glass or mirrors. The first kObstacles of so many.
    std::vector<std::string> obstacles;
    std::uint64_t obstacleCount = 0;
};

} // namespace abbe

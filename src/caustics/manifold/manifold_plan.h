// Which caustics are found by specular manifold sampling.
#pragma once

#include "caustics/shared/chain_signature.h"
#include "render/light.h"
#include "render/shape.h"

#include <array>
#include <vector>

namespace abbe {

// A shape that chains may start at, seen from the receiver. Render space, m.
struct SpecularCaster {
    const Shape* shape = nullptr;
    Vec3 centre; // of a ball around the shape: first directions are drawn towards it
    float radius = 0;
    // How often each kind of chain is tried, relative to the others, by ChainSignature::index(). 0: never, and such
    // chains are not covered: the path tracer keeps them.
    std::array<float, ChainSignature::kCount> weights{};
};

// Frozen before light is gathered: it says which light the path tracer leaves out.
struct ManifoldPlan {
    struct AskedLight {
        const Light* light = nullptr;
        float weight = 1; // > 0: how often it is asked, relative to the others
        // sr: where the lamp's image is larger than this, it is left to others: to merging or to the path tracer, whose
        // rays find it soon enough. The image of the whole lamp is meant, magnified as at the point of it that a chain
        // leads to. Next to caustics it has no bound, and estimates of it would have none either.
        float largestImage = 0.5f;
    };

    std::vector<SpecularCaster> casters; // those of casterCandidates() that are wanted
    std::vector<AskedLight> lights;      // with Light::paths() other than none
    // How many estimates a vertex asks for; their mean counts. Each has its own point of the lamp: where that decides
    // how much light there is, as near caustics, this is worth more than as many paths from the camera.
    std::uint32_t estimates = 1; // > 0
    // Solutions of which a trial in this many would find one are given up. Trials cost as much as there are solutions,
    // in the mean, however rare they are; the cap only keeps a single one from taking seconds.
    std::uint32_t maxTrials = 100'000;
};

} // namespace abbe

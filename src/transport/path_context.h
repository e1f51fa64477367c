// What the paths of one render share, and what those of one tile count.
#pragma once

#include "base/parallel.h"
#include "render/effect_counts.h"
#include "render/integrator.h"
#include "transport/loop_technique.h"

#include <cstdint>

namespace abbe {

class GlintPlan;
class LightArrival;
struct LightPathPlan;
class LightSampler;
class ManifoldListener;
class ManifoldSampler;
struct MergePlan;
class PathGuide;
class PulledShares;
class RadianceCache;
struct Scene;

// Vertices from which on no path is certain to go on.
inline constexpr std::uint32_t kLongPath = 64;

// Immutable while paths run, and outlives them.
struct PathContext {
    const Scene& scene;
    const LightSampler& lights;
    RenderSettings settings;
    bool choices = true;      // whether anything in the scene draws a light, a lobe or a place on a lens
    std::uint32_t strata = 1; // of stratified numbers
    LoopTechnique how = LoopTechnique(settings.technique);
    // For kernels with Effect::lightPaths: light paths beside camera paths; chains of delta interfaces, and who hears
    // of them.
    const LightPathPlan* lightPaths = nullptr;
    const ManifoldSampler* manifold = nullptr;
    ManifoldListener* manifoldListener = nullptr;
    const MergePlan* merging = nullptr;       // light that is found by merging, and left out of paths
    const GlintPlan* glints = nullptr;        // likewise by probes
    const PathGuide* guide = nullptr;         // where camera paths find light; null: as surfaces scatter
    const RadianceCache* distances = nullptr; // its cache, where they draw distances in media by it
    const LightArrival* arrival = nullptr;    // of lights, for choosing them; null: as if nothing was in their way
    const PulledShares* pulled = nullptr;     // of walks in solids; null: PulledShares::kUnknown of all
    // Set: what is in hand is left where it is, and does not count (PathCounters::left).
    const StopFlag* stop = &kNeverStop;

    // Whether directions are not those of surfaces alone.
    bool mixes() const { return how.evenly || guide; }
    bool toldToStop() const { return stop->load(std::memory_order_relaxed); }
};

// What manifold sampling came to (ManifoldSampler::sample). Whole numbers: the same in any order of adding.
struct ManifoldCounts {
    std::uint64_t estimates = 0;  // calls
    std::uint64_t found = 0;      // that came to some light
    std::uint64_t trials = 0;     // first directions
    std::uint64_t iterations = 0; // of Newton's method
    std::uint64_t rays = 0;
    std::uint64_t capped = 0;

    void add(const ManifoldCounts& b) {
        estimates += b.estimates;
        found += b.found;
        trials += b.trials;
        iterations += b.iterations;
        rays += b.rays;
        capped += b.capped;
    }
};

// What paths come to beside light.
struct PathCounters {
    std::uint64_t paths = 0, vertices = 0, shadowRays = 0, capped = 0;
    const void* cappedIn = nullptr; // the shape or the medium, of the last of them
    EffectCounts effects;
    ManifoldCounts manifold;
    // A path was left before its end, because the render is to end. Its rays are counted, but it is no sample.
    bool left = false;

    void add(const PathCounters& c) {
        paths += c.paths;
        vertices += c.vertices;
        shadowRays += c.shadowRays;
        capped += c.capped;
        if (c.cappedIn) cappedIn = c.cappedIn;
        effects.add(c.effects);
        manifold.add(c.manifold);
        left |= c.left;
    }
};

} // namespace abbe

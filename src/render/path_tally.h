// What samples came to, in numbers: one record for a tile, a block of light paths, a part and a whole render.
#pragma once

#include "render/effect_counts.h"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <type_traits>

namespace abbe {

// Why samples were dropped.
enum class DropCause : std::uint8_t { nan, infinite, negative }; // infinite: or beyond ExactSum::kLargest

// Densities of media that were found above the bound that tracking took for them. The image stays right, but is
// noisier if there are many.
struct DensityExcess {
    std::uint64_t lookups = 0; // all densities
    std::uint64_t above = 0;
    float most = 0; // density over bound

    void add(const DensityExcess& e) {
        lookups += e.lookups;
        above += e.above;
        most = std::max(most, e.most);
    }
};

// Whole numbers: the same in any order, but for rays of paths that were left because the render was to end
// (PathCounters::left) and were taken again.
struct PathTally {
    std::uint64_t paths = 0;
    std::uint64_t vertices = 0;
    std::uint64_t shadowRays = 0;
    std::uint64_t cappedPaths = 0;          // reached the safety cap on vertices (PathWalk::kMaxVertices)
    std::array<std::uint64_t, 3> dropped{}; // by DropCause
    DensityExcess excess;
    EffectCounts effects;
    double coreSeconds = 0; // summed over threads
    // Paths that started at lights, beside `paths`; their rays, and pixels that they were added to. All other counts of
    // rays are of camera paths.
    std::uint64_t lightPaths = 0, lightRays = 0, splats = 0;
    std::uint64_t rounds = 0; // of merging, whose paths count as light paths

    std::uint64_t rays() const { return vertices + shadowRays + lightRays; }
    void add(const PathTally&);
};

// The counters of a tally, which checkpoints, reports and headers of images are made of: a new one is added here, and
// at the end, since checkpoints hold them in this order. `Tally` may be const.
template <typename Tally>
requires std::derived_from<std::remove_const_t<Tally>, PathTally>
auto countersOf(Tally& t) {
    using enum Reported;
    const auto dropped = [&t](DropCause cause) { return &t.dropped[static_cast<std::size_t>(cause)]; };
    return std::array{
        counter(t.paths, "paths", "paths", always),
        counter(t.vertices, "vertices", "vertices"),
        counter(t.shadowRays, "shadow_rays", "shadow rays"),
        counter(t.cappedPaths, "capped_paths", "paths at the cap", always),
        counter(*dropped(DropCause::nan), "nan", "samples", asDropped),
        counter(*dropped(DropCause::infinite), "infinite", "samples", asDropped),
        counter(*dropped(DropCause::negative), "negative", "samples", asDropped),
        counter(t.excess.lookups, "densities", "densities"),
        counter(t.excess.above, "densities_above_bound", "densities"),
        counter(t.lightPaths, "light_paths", "paths from lights", withLightPaths),
        counter(t.lightRays, "light_rays", "rays from lights"),
        counter(t.splats, "splats", "splats", withLightPaths),
        counter(t.rounds, "rounds", "rounds of merging", withRounds),
    };
}

// Whether reports and headers have a counter of this tally.
inline bool isReported(const Counter<const std::uint64_t>& c, const PathTally& t) {
    return c.reported == Reported::always || (c.reported == Reported::withLightPaths && t.lightPaths > 0) ||
           (c.reported == Reported::withRounds && t.rounds > 0);
}

inline void PathTally::add(const PathTally& t) {
    addCounters(countersOf(*this), countersOf(t));
    excess.most = std::max(excess.most, t.excess.most);
    effects.add(t.effects);
    coreSeconds += t.coreSeconds;
}

} // namespace abbe

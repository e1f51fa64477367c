// How often the parts of light transport were at work: whole numbers that follow from the samples alone, whoever took
// them in which order.
#pragma once

#include "base/work.h"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace abbe {

// Whether reports and headers have it.
enum class Reported : std::uint8_t { never, always, withLightPaths, withRounds, asDropped };

// A counter of a record with its name, so that each is named in one place. `Count`: std::uint64_t, perhaps const.
// Counters of several records add up by sums.
template <typename Count> struct Counter {
    Count* place;
    const char* name; // in JSON: "light_paths"
    const char* unit; // for people: "paths from lights"
    Reported reported;
};

template <typename Count>
Counter<Count> counter(Count& place, const char* name, const char* unit, Reported reported = Reported::never) {
    return {&place, name, unit, reported};
}

// Lists of the same record type.
template <typename Sums, typename Summands> void addCounters(const Sums& sums, const Summands& summands) {
    for (std::size_t i = 0; i < sums.size(); ++i) *sums[i].place += *summands[i].place;
}

struct VolumeCounts {
    std::uint64_t collisions = 0; // tentative ones, of paths
    std::uint64_t lookups = 0;    // of density, for transmittance
    std::uint64_t scattered = 0;  // collisions from which a path went on: rays that start in it
    std::uint64_t first = 0;      // paths that met it before any other medium: see EffectCounts::untouched

    void add(const VolumeCounts&);
    bool operator==(const VolumeCounts&) const = default;
};

// Here and below in the order in which checkpoints hold them; the records may be const.
template <typename Counts>
requires std::same_as<std::remove_const_t<Counts>, VolumeCounts>
auto countersOf(Counts& v) {
    return std::array{
        counter(v.collisions, "collisions", "tentative collisions"),
        counter(v.lookups, "lookups", "densities"),
        counter(v.scattered, "scattered", "collisions"),
        counter(v.first, "first", "paths"),
    };
}

// Beside PathTally, whose vertices and shadow rays are the rest of the rays.
struct EffectCounts {
    std::uint64_t noRays = 0;          // paths without a ray, as at a lens's rim
    std::uint64_t crossings = 0;       // rays that went on straight through a surface
    std::uint64_t shadowCrossings = 0; // the same on the way to a light
    std::uint64_t heroRays = 0;        // of paths, with one wavelength left
    std::uint64_t textureLookups = 0;
    std::uint64_t movingHits = 0; // of surfaces that are elsewhere at other times
    std::uint64_t untouched = 0;  // rays of paths that no medium has scattered, in kernels with media
    std::array<VolumeCounts, kVolumeWorks> volumes{}; // by volumeRow()

    void add(const EffectCounts&);
    bool operator==(const EffectCounts&) const = default;
};

// Without those of volumes.
template <typename Counts>
requires std::same_as<std::remove_const_t<Counts>, EffectCounts>
auto countersOf(Counts& c) {
    return std::array{
        counter(c.noRays, "no_rays", "paths"),
        counter(c.crossings, "crossings", "rays"),
        counter(c.shadowCrossings, "shadow_crossings", "shadow rays"),
        counter(c.heroRays, "hero_rays", "rays"),
        counter(c.textureLookups, "texture_lookups", "lookups"),
        counter(c.movingHits, "moving_hits", "hits"),
        counter(c.untouched, "untouched", "rays"),
    };
}

inline void VolumeCounts::add(const VolumeCounts& v) { addCounters(countersOf(*this), countersOf(v)); }

inline void EffectCounts::add(const EffectCounts& c) {
    addCounters(countersOf(*this), countersOf(c));
    for (std::size_t i = 0; i < volumes.size(); ++i) volumes[i].add(c.volumes[i]);
}

} // namespace abbe

// Counters of a record with their names, so that each is named in one place.
#pragma once

#include <cstddef>
#include <cstdint>

namespace abbe {

// Whether reports and headers have it.
enum class Reported : std::uint8_t { never, always, withLightPaths, withRounds, asDropped };

// `Count`: std::uint64_t, perhaps const. Counters of several records add up by sums.
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

} // namespace abbe

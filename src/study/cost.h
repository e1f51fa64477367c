// What a render spent, row by row: seconds that add up to the time on the wall, and counts (docs/cost.md).
#pragma once

#include "base/work_clock.h"
#include "render/integrator.h"

#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

struct Scene;

struct CostRow {
    std::string id;           // "embree", "volume fog": of one word, or two for what the scene names
    std::string label;        // for people
    double seconds = 0;       // on the wall, all threads together; the rows add up
    double uncertainty = 0;   // s: the seconds are right to within this in 95 of 100 cases
    double elsewhere = 0;     // s of other rows that were spent because of this; rows may share them
    std::uint64_t rays = 0;   // that were cast for it
    std::uint64_t count = 0;  // of what `counted` says
    std::string counted = {}; // "lookups"; empty: nothing but rays
    std::string note = {};    // what the row cannot tell; empty: nothing
    std::uint64_t first = 0;  // of volumes: paths that it was the first to scatter
};

struct CostReport {
    double seconds = 0;          // on the wall, by a clock of its own, with those of earlier runs and of parts
    double accounted = 0;        // sum of the rows over that
    double rendering = 0;        // s of the rows from camera to film: what takes longer with more samples
    int threads = 0;             // of this run
    std::uint64_t looks = 0;     // of the clock
    std::uint64_t paths = 0;     // of the image
    std::uint64_t untouched = 0; // rays of them that no medium had scattered; 0 in scenes without media
    std::vector<CostRow> rows;

    const CostRow* find(std::string_view id) const; // null if there is none
};

struct CostInput {
    const WorkReading* work = nullptr;
    const RenderStatistics* statistics = nullptr;
    const Scene* scene = nullptr;
    double seconds = 0; // on the wall
    int threads = 1;
};
CostReport makeCostReport(const CostInput&);

} // namespace abbe

// Where a study keeps what it has done, so that it can be continued: what is kept of a curve while it goes on.
#pragma once

#include "study/reference_pair.h"
#include "study/seed_runs.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// One rung of a curve: `first` is the image of the first seed; `sum` and `tiles` add up over the seeds that were
// measured (ReferencePair::biasSquared).
struct CurveRung {
    std::uint32_t samples = 0; // per pixel
    StudyImage first, sum;
    std::vector<double> tiles;
};

// A variant's seeds so far. The first one is rendered before there is a reference, so it may wait to be measured.
struct CurveRecord {
    std::string id; // of the variant
    std::vector<CurveRung> rungs;
    std::vector<SeedRun> runs;
    std::size_t measured = 0; // of the runs

    // The images of a seed, of as many rungs as there are.
    void measure(const ReferencePair&, const std::vector<StudyImage>& images);
};

// Both halves, and what they took.
struct StoredReference {
    StudyImage a, b;
    std::uint32_t samples = 0; // per pixel, of each half
    double seconds = 0;        // wall clock
};

// What is saved is whole or not there at all. Functions throw what files throw.
struct StudyStore {
    std::function<std::optional<CurveRecord>(const std::string& id)> loadCurve;
    std::function<void(const CurveRecord&)> saveCurve;
    std::function<std::optional<StoredReference>()> loadReference;
    std::function<void(const StoredReference&)> saveReference;
};

} // namespace abbe

// Where a study keeps what it has done, so that it can be continued.
#pragma once

#include "study/curve_record.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace abbe {

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

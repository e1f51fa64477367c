// What happened in one sample, told vertex by vertex.
#pragma once

#include "app/json.h"
#include "reports/found_fault.h"

#include <string>

namespace abbe {

struct ReplayedSample {
    SampleId id;
    const PathRecord& record;
    const FoundFault* fault = nullptr; // of a sample that was dropped
    double exposure = 1;               // factor of what the film adds
};

// For people: a block of lines.
std::string storyText(const ReplayedSample&, const Scene&);
Json storyJson(const ReplayedSample&, const Scene&);

} // namespace abbe

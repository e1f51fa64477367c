// Where a sample that is no radiance went wrong.
#pragma once

#include "render/integrator.h"
#include "rendering/path_record.h"

#include <optional>
#include <string>

namespace abbe {

// The first number of the path that is negative or not finite.
struct SampleFault {
    // Who gave it.
    enum class Culprit : std::uint8_t { camera, material, light, medium };

    Culprit culprit = Culprit::camera;
    const void* who = nullptr; // its Material, Light, MediumEmission or Medium, as far as known
    const char* what = "ray";  // of the culprit: "value", "density", …
    DropCause cause = DropCause::nan;
    std::uint32_t lanes = 0xff; // in which it is; all for what is no spectrum
    float number = 0;           // itself; of the first lane
    PathEvent event;            // at the vertex where it came up
};

// Of a sample that was dropped.
SampleFault findFault(const PathRecord&);

} // namespace abbe

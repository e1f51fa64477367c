// What the program decides on light paths, manifold sampling, merging and glints before it renders a scene.
#pragma once

#include "support/scene_test.h"

namespace abbe::test {

inline LightPathFindings lightPlanOf(const TestScene& test, const RenderSettings& settings) {
    const RecordingFilm like(test.built().film, 2);
    return makePathTracer(test.scene().effects)->findLightPaths(test.scene(), like, settings);
}

} // namespace abbe::test

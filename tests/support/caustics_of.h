// What the program decides on light paths, manifold sampling, merging and glints before it renders a scene.
#pragma once

#include "caustics/glints/glint_plan.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/manifold/manifold_plan.h"
#include "caustics/merging/merge_plan.h"
#include "support/scene_test.h"

namespace abbe::test {

inline CausticFindings causticsOf(const TestScene& test, const RenderSettings& settings) {
    const RecordingFilm like(test.built().film, 2);
    return makePathTracer(test.scene().effects)->findCaustics(test.scene(), like, settings);
}

} // namespace abbe::test

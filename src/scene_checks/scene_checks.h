// What is suspicious about a scene as a whole: things that are allowed one by one and hardly meant together.
#pragma once

#include "base/diagnostic.h"
#include "scene/build.h"
#include "schema/scene_tree.h"

#include <cstdint>

namespace abbe {

enum class CheckDepth : std::uint8_t {
    amounts, // sizes, distances and powers: no work to speak of, so before every render
    surfaces // also all faces: closed solids, their outer sides, where they overlap, what is around the camera
};

struct CheckOutcome {
    // The camera is inside of something closed that no light passes. Whether it is dark there takes a scene that was
    // built with its geometry (W0696).
    bool cameraInBody = false;
};

// Warnings W0605 to W0613, located; of a scene with errors none. Surfaces are looked at in n log n of the faces, pairs
// of solids by a fixed number of lines in all (checks::kMostOverlapLines). Memory: some 60 bytes a triangle of the
// largest refracting mesh, and one tree at a time over the solids whose boxes meet, or around the camera.
CheckOutcome checkWholeScene(const BuiltScene&, const schema::SceneTree&, CheckDepth, Diagnostics&);

} // namespace abbe

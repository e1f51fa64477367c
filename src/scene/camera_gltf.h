// Cameras out of glTF files: the file says where they stand and what they see, the scene how they focus and expose.
#pragma once

#include "cameras/perspective.h"

namespace abbe {

struct GltfCameraParams : PerspectiveParams { // its place, `lens`, `fov` and `squeeze` are the file's
    schema::Text file;
    schema::Text name; // of a node with a camera; the only camera if empty
};

schema::TypeInfo gltfCameraType();

// The scale of the node has no effect. The vertical angle or height of the file is kept whatever the shape of the film.
// Nothing after an error.
std::optional<PlacedCamera> makeGltfCamera(const GltfCameraParams&, const CameraContext&, Diagnostics&);

} // namespace abbe

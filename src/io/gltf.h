// Meshes and cameras from glTF 2.0 files.
#pragma once

#include "io/mesh_file.h"
#include "math/transform.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// What to take of a file: what is empty leaves nothing out.
struct GltfSelection {
    std::string node; // this node and those below it, wherever they are
    std::string mesh; // instances of this mesh only
    // The pose: of this animation (the first one if there is only a time) at this time in s (its first key if there is
    // only an animation); without both that of the nodes as they are.
    std::string animation = {};
    std::optional<double> time = {};
};

// Whether the bytes are a binary glTF file, or JSON: no other format of meshes starts with a brace.
bool looksLikeGltf(std::string_view bytes);

// The triangles of the default scene (of all root nodes if there is none), in metres with y up as the format states
// them: lists, strips and fans, with the transforms of their nodes applied, faces outwards under mirrors, v turned
// upwards as in OBJ. A primitive without normals or texture coordinates beside others that have them gets zeros. One
// group for every primitive of every node, named after the node or else its mesh. Images are not looked for.
// Morph targets and skins are as they are in the pose; copies of EXT_mesh_gpu_instancing belong to the group of their
// node. Vertex colours are the attributes `color` and `alpha`, 1 where a primitive has none. Points and lines are left
// out, with a remark in MeshFile::leftOut. Geometry compressed by Draco or meshopt is unpacked; other extensions that a
// file requires and that change geometry are errors. Throws IoError that names the place: the byte, or the path to the
// JSON value.
// `name` is the path: buffers in files of their own are looked up beside it.
MeshFile parseGltf(std::string_view bytes, const std::string& name, const GltfSelection& = {});
MeshFile readGltf(const std::string& path, const GltfSelection& = {});

// The files beside a glTF file that its buffers are in, as paths relative to its folder; of those, a file that cannot
// be read names none. Images are not among them: nothing reads them.
std::vector<std::string> gltfBufferFiles(const std::string& path);

// A camera of the default scene: it looks along the -z axis of its placement, with +y up.
struct GltfCamera {
    std::string name; // of its node, or else its own
    bool perspective = true;
    double verticalFov = 0;               // radians, full angle; perspective only
    double aspect = 0;                    // width / height, 0 where the picture decides; perspective only
    double halfWidth = 0, halfHeight = 0; // m; orthographic only
    double near = 0, far = 0;             // m; far is 0 for none
    Transform placement;                  // to the scene of the file
};

// In the order of the scene's nodes. Throws IoError.
std::vector<GltfCamera> parseGltfCameras(std::string_view bytes, const std::string& name);
std::vector<GltfCamera> readGltfCameras(const std::string& path);

} // namespace abbe

// glTF, text and binary: meshes and cameras.
#include "io/gltf.h"

#include "fuzz/targets/mesh_checks.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    fuzz::reading([&] { fuzz::checkMesh(parseGltf(bytes, "/nowhere/fuzz.gltf")); });
    fuzz::reading([&] {
        for (const GltfCamera& camera : parseGltfCameras(bytes, "/nowhere/fuzz.gltf"))
            fuzz::require(camera.placement.isFinite(), "a camera that is nowhere");
    });
    return 0;
}

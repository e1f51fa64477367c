// glTF, text and binary: meshes and cameras; poses of the animations, primitives, copies and images.
#include "io/gltf.h"

#include "fuzz/targets/mesh_checks.h"
#include "io/gltf_scene.h"

using namespace abbe;

namespace {

void checkPose(const GltfDocument& document, const GltfPose& pose) {
    for (const GltfNodePose& node : pose.nodes()) {
        fuzz::require(node.world.isFinite(), "a node that is nowhere");
        const tinygltf::Mesh* const mesh = document.meshOf(node.node);
        if (!mesh) continue;
        fuzz::reading([&] { gltfInstances(document, node.node); });
        for (int i = 0; i < static_cast<int>(std::min<std::size_t>(mesh->primitives.size(), 8)); ++i)
            fuzz::reading([&] {
                const GltfPrimitive p = gltfPrimitive(document, pose, node.node, i);
                MeshFile file;
                file.mesh = p.mesh;
                fuzz::checkMesh(file);
                const std::size_t n = p.mesh.positions.size();
                fuzz::require(p.uvs1.empty() || p.uvs1.size() == n, "second coordinates of other vertices");
                fuzz::require(p.tangents.empty() || p.tangents.size() == n, "tangents of other vertices");
                for (const MeshAttribute& a : p.mesh.attributes)
                    fuzz::require(a.values.size() == n * static_cast<std::size_t>(a.channels),
                                  "colours of other vertices");
            });
    }
}

void checkScene(const std::string& bytes) {
    const GltfDocument document(bytes, "/nowhere/fuzz.gltf");
    const int animations = static_cast<int>(std::min<std::size_t>(document.model().animations.size(), 4));
    for (int a = -1; a < animations; ++a)
        fuzz::reading([&] {
            const GltfAnimation animation(document, a);
            const auto span = animation.span().value_or(std::pair(0.0, 0.0));
            checkPose(document, animation.pose(0.4 * span.first + 0.6 * span.second));
        });
    for (std::size_t i = 0; i < std::min<std::size_t>(document.model().images.size(), 8); ++i)
        fuzz::reading([&] {
            const GltfImage image = gltfImage(document, static_cast<int>(i));
            fuzz::require(image.bytes.empty() != image.file.empty(), "an image of nothing, or of two things");
        });
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    fuzz::reading([&] { fuzz::checkMesh(parseGltf(bytes, "/nowhere/fuzz.gltf")); });
    fuzz::reading([&] {
        for (const GltfCamera& camera : parseGltfCameras(bytes, "/nowhere/fuzz.gltf"))
            fuzz::require(camera.placement.isFinite(), "a camera that is nowhere");
    });
    fuzz::reading([&] { checkScene(bytes); });
    return 0;
}

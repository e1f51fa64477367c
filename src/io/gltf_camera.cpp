#include "io/file_bytes.h"
#include "io/gltf.h"
#include "io/gltf_document.h"

#include <fmt/format.h>

namespace abbe {

namespace {

GltfCamera readCamera(const GltfDocument& document, const tinygltf::Camera& camera, int index) {
    const auto check = [&](bool good, const char* what) {
        if (!good) document.fail(fmt::format("cameras[{}].{}", index, what));
    };
    const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    GltfCamera result;
    result.name = camera.name;
    result.perspective = camera.type == "perspective";
    if (result.perspective) {
        const auto& p = camera.perspective;
        check(positive(p.yfov) && p.yfov < kPiD, "perspective.yfov is no angle between 0 and π");
        check(p.aspectRatio >= 0 && std::isfinite(p.aspectRatio), "perspective.aspectRatio is negative");
        result.verticalFov = p.yfov;
        result.aspect = p.aspectRatio;
        result.near = p.znear;
        result.far = p.zfar;
    } else {
        check(camera.type == "orthographic", "type is neither perspective nor orthographic");
        const auto& o = camera.orthographic;
        check(positive(std::abs(o.xmag)) && positive(std::abs(o.ymag)),
              "orthographic.xmag and ymag are not both above 0");
        result.halfWidth = std::abs(o.xmag);
        result.halfHeight = std::abs(o.ymag);
        result.near = o.znear;
        result.far = o.zfar;
    }
    return result;
}

} // namespace

std::vector<GltfCamera> parseGltfCameras(std::string_view bytes, const std::string& name) {
    const GltfDocument document(bytes, name);
    const auto& model = document.model();
    std::vector<GltfCamera> cameras;
    for (const PlacedGltfNode& placed : document.nodes({})) {
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(placed.node)];
        if (node.camera < 0) continue;
        if (static_cast<std::size_t>(node.camera) >= model.cameras.size())
            document.fail(fmt::format("nodes[{}].camera is {}, but there are {}", placed.node, node.camera,
                                      model.cameras.size()));
        cameras.push_back(readCamera(document, model.cameras[static_cast<std::size_t>(node.camera)], node.camera));
        if (!node.name.empty()) cameras.back().name = node.name;
        cameras.back().placement = placed.map;
    }
    return cameras;
}

std::vector<GltfCamera> readGltfCameras(const std::string& path) { return parseGltfCameras(readFileBytes(path), path); }

} // namespace abbe

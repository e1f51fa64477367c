// Lights and cameras.
#include "exchange/gltf/gltf_nodes.h"
#include "exchange/shared/placement.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

int gltfLightOf(const GltfContext& ctx, int node) {
    const auto& extensions = ctx.model().nodes[static_cast<std::size_t>(node)].extensions;
    const auto found = extensions.find("KHR_lights_punctual");
    if (found == extensions.end() || !found->second.Has("light")) return -1;
    return gltfIndex(found->second.Get("light"));
}

namespace {

// cd or lx of a light, whose colour is linear Rec. 709: the luminance of the colour times its intensity.
double writeGltfLightColor(SceneNode& node, const tinygltf::Light& light) {
    Vec3d color(1, 1, 1);
    if (light.color.size() == 3) color = {light.color[0], light.color[1], light.color[2]};
    if (color != Vec3d(1, 1, 1) && maxComponent(color) > 0) node.child("color").word("rgb").vector(color);
    return light.intensity * dot(color, Vec3d(0.2126, 0.7152, 0.0722));
}

void writeGltfCone(SceneNode& node, const tinygltf::Light& light, const std::string& name, Span span,
                   GltfContext& ctx) {
    double outer = light.spot.outerConeAngle, inner = light.spot.innerConeAngle;
    if (!(outer > 0 && outer <= kPiD / 2 + 1e-6 && inner >= 0 && inner <= outer)) {
        ctx.import.approximated(&node, span, fmt::format("the cone of {}", name),
                                fmt::format("from {} to {} rad: between 0 and π/2, the inner one first", inner, outer));
        outer = outer > 0 ? std::min(outer, kPiD / 2) : kPiD / 4;
        inner = std::clamp(inner, 0.0, outer);
    }
    node.child("angle").number(std::max(2 * outer / kDegree, 0.01)).word("deg");
    node.child("inner-angle").number(2 * inner / kDegree).word("deg");
    constexpr double kVisible = 0.02; // rad
    if (outer - inner > kVisible)
        ctx.import.approximated(&node, span, fmt::format("the edge of {}", name),
                                "between both cones it falls as t² (3 - 2t), there as t²");
}

} // namespace

bool writeGltfLight(SceneNode& node, int index, GltfContext& ctx) {
    const auto& lights = ctx.model().lights;
    const Span span = ctx.places.of("extensions", -1);
    if (static_cast<std::size_t>(index) >= lights.size()) {
        ctx.import.diagnostics.error("E0802", span,
                                     fmt::format("a node has light {}, but the file has {}", index, lights.size()));
        return false;
    }
    const tinygltf::Light& light = lights[static_cast<std::size_t>(index)];
    const std::string name = gltfName("light", "lights", index, light.name);
    const auto good = [](double x) { return x >= 0 && x <= 1e15; };
    if (!good(light.intensity) || !std::ranges::all_of(light.color, good)) {
        ctx.import.diagnostics.error("E0802", span, fmt::format("{} has an amount below 0 or above 1e15", name));
        return false;
    }
    const bool distant = light.type == "directional", spot = light.type == "spot";
    if (!distant && !spot && light.type != "point") {
        ctx.import.leftOut(nullptr, span, name, fmt::format("there is no light of type `{}`", light.type));
        return false;
    }
    node.word(distant ? "sun" : light.type);
    if (distant) node.child("toward").vector({0, 0, -1});
    if (distant) node.child("angular-diameter").number(0).word("deg");
    const double amount = writeGltfLightColor(node, light);
    node.child(distant ? "irradiance" : "intensity").number(amount).word(distant ? "lx" : "cd");
    if (spot) writeGltfCone(node, light, name, span, ctx);
    if (light.range > 0 && !distant)
        ctx.import.leftOut(&node, span, fmt::format("the range of {}", name), "light has no end");
    return true;
}

namespace {

struct GltfFrame {
    double width = 1280, height = 720; // pixels
};

GltfFrame gltfFrame(double aspect) {
    constexpr double kLongest = 16384;
    GltfFrame frame;
    if (aspect > 0 && std::isfinite(aspect)) frame.width = std::clamp(std::round(frame.height * aspect), 1.0, kLongest);
    return frame;
}

// Fields and sizes are checked as the node is written: false if the camera makes no sense.
bool writeGltfLens(SceneNode& node, const tinygltf::Camera& camera, const std::string& name, Span span,
                   std::optional<GltfFrame>& frame, GltfContext& ctx) {
    const auto fault = [&](std::string_view what) {
        ctx.import.diagnostics.error("E0802", span, fmt::format("{} of {}", what, name));
        return false;
    };
    const auto positive = [](double x) { return x > 0 && x < 1e14; };
    if (camera.type == "orthographic") {
        const auto& o = camera.orthographic;
        if (!positive(std::abs(o.xmag)) || !positive(std::abs(o.ymag))) return fault("xmag and ymag are 0: the size");
        if (!frame) frame = gltfFrame(std::abs(o.xmag / o.ymag));
        node.word("orthographic").child("height").number(2 * std::abs(o.ymag)).word("m");
        return true;
    }
    const auto& p = camera.perspective;
    if (camera.type != "perspective") return fault("neither perspective nor orthographic is the type");
    if (!positive(p.yfov) || p.yfov >= kPiD) return fault("an angle between 0 and π is no yfov");
    if (!frame) frame = gltfFrame(p.aspectRatio);
    const double across = std::tan(p.yfov / 2) * frame->width / frame->height;
    node.child("fov").number(std::clamp(2 * std::atan(across) / kDegree, 0.001, 179.9)).word("deg");
    return true;
}

void placeGltfCamera(SceneNode& node, const GltfKeys& keys, const std::string& name, Span span, GltfContext& ctx) {
    GltfKeys rigid;
    for (const auto& [time, map] : keys)
        if (const auto turn = gltfRigid(map)) rigid.emplace_back(time, *turn);
    if (rigid.empty())
        return ctx.import.approximated(&node, span, name, "its node has no size: it looks along -z from the origin");
    if (rigid.size() > 1) return writeGltfKeys(node, rigid);
    const Transform& map = rigid[0].second;
    node.child("from").vector(map.t);
    node.child("look-at").vector(map.point({0, 0, -1}));
    node.child("up").vector(map.vector({0, 1, 0}));
}

} // namespace

bool writeGltfCameras(GltfContext& ctx) {
    std::optional<GltfFrame> frame; // of the first one
    for (const GltfNodePose& pose : ctx.pose.nodes()) {
        const tinygltf::Node& node = ctx.model().nodes[static_cast<std::size_t>(pose.node)];
        if (node.camera < 0) continue;
        const Span span = ctx.places.of("cameras", node.camera);
        if (static_cast<std::size_t>(node.camera) >= ctx.model().cameras.size()) {
            ctx.import.diagnostics.error("E0802", ctx.places.of("nodes", pose.node),
                                         fmt::format("nodes[{}].camera is {}, but the file has {}", pose.node,
                                                     node.camera, ctx.model().cameras.size()));
            continue;
        }
        const tinygltf::Camera& camera = ctx.model().cameras[static_cast<std::size_t>(node.camera)];
        const std::string name = gltfName("camera", "cameras", node.camera, camera.name);
        SceneNode written("camera");
        written.name(ctx.cameraNames.take(node.name.empty() ? camera.name : node.name, "camera"));
        if (!writeGltfLens(written, camera, name, span, frame, ctx)) continue;
        placeGltfCamera(written, gltfWorldKeys(ctx, pose.node), name, span, ctx);
        if (ctx.measures) written.child("exposure").word("auto");
        ctx.import.nodes.push_back(std::move(written));
    }
    if (!frame) return false;
    ctx.define("film").child("size").number(frame->width).number(frame->height);
    return true;
}

} // namespace abbe::exchange

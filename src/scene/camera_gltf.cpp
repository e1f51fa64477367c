#include "scene/camera_gltf.h"

#include "cameras/orthographic.h"
#include "io/gltf.h"
#include "scene/file_faults.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

using schema::field;
using schema::FieldInfo;
using schema::FieldType;

namespace {

// What the file says instead.
constexpr std::array<std::string_view, 8> kFromFile{"from",      "look-at", "up",  "at",
                                                    "transform", "lens",    "fov", "squeeze"};

Span spanOf(const schema::Text& text, Span otherwise) { return text.span.valid() ? text.span : otherwise; }

std::string listOf(const std::vector<GltfCamera>& cameras) {
    std::vector<std::string_view> names;
    for (const GltfCamera& c : cameras) names.push_back(c.name);
    return names.empty() ? "it has none" : "its cameras are " + schema::quotedList(names);
}

// The camera with the name, or the only one. Nothing after a diagnostic.
const GltfCamera* chosen(const std::vector<GltfCamera>& cameras, const GltfCameraParams& params, Span span,
                         Diagnostics& diagnostics) {
    const std::string& name = params.name.value;
    const auto matches = [&](const GltfCamera& c) { return name.empty() || c.name == name; };
    const auto count = std::ranges::count_if(cameras, matches);
    if (count == 1) return &*std::ranges::find_if(cameras, matches);
    if (name.empty())
        diagnostics
            .error("E0358", spanOf(params.file, span),
                   count == 0 ? "the file has no camera" : "the file has several cameras",
                   count == 0 ? "" : "which one, `name` says")
            .help = listOf(cameras);
    else
        diagnostics
            .error("E0358", spanOf(params.name, span),
                   count == 0 ? fmt::format("the file has no camera `{}`", name)
                              : fmt::format("{} cameras are named `{}`", count, name))
            .help = listOf(cameras);
    return nullptr;
}

// The placement of the node in the axes of the scene, without its scale; nothing if it is no camera's.
std::optional<Transform> placementOf(const GltfCamera& camera, bool zUp) {
    const Transform toScene = zUp ? Transform::rotate({1, 0, 0}, kPiD / 2) : Transform{};
    Transform place = camera.placement.then(toScene);
    const auto scale = place.uniformScale();
    if (!scale || !(*scale > 0) || !(place.determinant() > 0)) return std::nullopt;
    for (auto& row : place.a)
        for (double& v : row) v /= *scale;
    return place;
}

bool hasOptics(const GltfCameraParams& p) {
    return p.fStop || p.aperture || p.focus || p.iso || p.shift != Vec2d{} || p.tilt != Vec2d{};
}

} // namespace

schema::TypeInfo gltfCameraType() {
    using P = GltfCameraParams;
    schema::TypeInfo type{.kind = schema::Kind::camera,
                          .name = "gltf",
                          .doc = "A camera of a glTF file, perspective or orthographic.",
                          .example = "camera gltf \"shot.glb\" { name \"Camera.001\"; f-stop 2.8; focus 3 m }",
                          .fields = {}};
    type.fields.push_back(field(FieldType::file, "file", &P::file)
                              .argument(0)
                              .required()
                              .doc("glTF file, binary or text. It is in metres, with y up.")
                              .example("file \"shot.glb\"")
                              .synonyms({"filename", "path"}));
    type.fields.push_back(field(FieldType::text, "name", &P::name)
                              .doc("Name of the camera's node. Default: the only camera of the file.")
                              .example("name \"Camera.001\"")
                              .synonyms({"node", "camera"}));
    for (FieldInfo& f : perspectiveType().fields)
        if (std::ranges::find(kFromFile, f.name) == kFromFile.end()) type.fields.push_back(std::move(f));
    return type;
}

std::optional<PlacedCamera> makeGltfCamera(const GltfCameraParams& params, const CameraContext& context,
                                           Diagnostics& diagnostics) {
    std::vector<GltfCamera> cameras;
    if (!readsFile(params.file.value, spanOf(params.file, context.span), diagnostics,
                   [&] { cameras = readGltfCameras(params.file.value); }))
        return std::nullopt;
    const GltfCamera* camera = chosen(cameras, params, context.span, diagnostics);
    if (!camera) return std::nullopt;
    const auto place = placementOf(*camera, context.zUp);
    if (!place) {
        diagnostics.error("E0351", spanOf(params.name, context.span),
                          fmt::format("the node of camera `{}` is stretched unevenly or mirrored", camera->name));
        return std::nullopt;
    }
    GltfCameraParams placed = params;
    placed.transform = *place;
    if (camera->perspective) {
        const double aspect = static_cast<double>(context.filmSize.x) / context.filmSize.y;
        placed.fov = 2 * std::atan(std::tan(camera->verticalFov / 2) * aspect);
        return makePerspective(placed, context, diagnostics);
    }
    if (hasOptics(params)) {
        diagnostics.error("E0358", context.span, fmt::format("camera `{}` is orthographic", camera->name),
                          "it has no aperture, focus, speed, shift or tilt");
        return std::nullopt;
    }
    OrthographicParams parallel;
    static_cast<CameraParams&>(parallel) = placed;
    parallel.height = 2 * camera->halfHeight;
    return makeOrthographic(parallel, context, diagnostics);
}

} // namespace abbe

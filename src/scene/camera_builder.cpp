#include "scene/camera_builder.h"

#include "cameras/altered_camera.h"
#include "cameras/projections.h"
#include "io/gltf.h"
#include "math/vec.h"
#include "scene/file_faults.h"
#include "scene/registry.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

using schema::Kind;

// Looks through groups, whose transforms add up to `place`; the parts of objects have many places or none.
const schema::Definition* CameraBuilder::findShape(const std::vector<Definition>& definitions, std::string_view name,
                                                   double time, Transform& place) {
    for (const Definition& d : definitions) {
        if (d.kind == Kind::shape && d.name == name) return &d;
        if (d.kind != Kind::group) continue;
        if (const Definition* found = findShape(d.children, name, time, place)) {
            Diagnostics again; // what is wrong with the transform is reported when the group is placed
            for (const schema::Node& property : d.properties)
                if (property.name() == "transform")
                    place = place.then(
                        schema::bindMotion(property, context_.tree.headerOf(property.headSpan()), again).at(time));
            return found;
        }
    }
    return nullptr;
}

std::optional<Vec3d> CameraBuilder::middleOfShape(std::string_view name, double time) {
    Transform toWorld;
    const Definition* d = findShape(context_.tree.definitions, name, time, toWorld);
    if (!d) return std::nullopt;
    LoadedShape& loaded = shapes_.loaded(*d);
    if (!loaded.sound || loaded.infinite) return std::nullopt;
    const Transform place = loaded.common.transform.at(time).then(toWorld);
    Bounds3d box;
    if (loaded.mesh) {
        for (const Vec3& p : loaded.mesh->positions) box.add(place.point(loaded.meshOrigin + Vec3d(p)));
    } else if (const auto shape = loaded.place(place)) {
        box = {Vec3d(shape->bounds().lower), Vec3d(shape->bounds().upper)};
    }
    return box.empty() ? std::nullopt : std::optional((box.lower + box.upper) / 2);
}

CameraContext CameraBuilder::contextOf(const Definition& d) {
    CameraContext camera;
    camera.zUp = context_.tree.header.zUp;
    camera.filmSize = {static_cast<int>(context_.built.film.size.x), static_cast<int>(context_.built.film.size.y)};
    camera.span = d.span;
    if (const auto frame = context_.tree.frame) camera.frameTime = *frame / context_.built.render.fps;
    camera.middleOf = [this](std::string_view name, double time) { return middleOfShape(name, time); };
    return camera;
}

namespace {

// What the middle of the picture shows lies at some distance, where nobody says what it is.
CameraPose poseOf(const PlacedCamera& placed, Vec3d upright) {
    constexpr double kSomeDistance = 1, kLevel = 1e-6;
    const Transform toWorld = placed.toWorld.at(placed.shutter.open);
    const auto axis = [&](Vec3d v) { return normalize(toWorld.vector(v)); };
    const Vec3d ahead = axis({0, 0, -1});
    const bool level = std::abs(dot(axis({1, 0, 0}), upright)) < kLevel && std::abs(dot(ahead, upright)) < 1 - kLevel;
    return {placed.origin, placed.origin + ahead * placed.lookAtDistance.value_or(kSomeDistance),
            level ? upright : axis({0, 1, 0}), 1};
}

} // namespace

void CameraBuilder::build() {
    BuiltScene& built = context_.built;
    const Definition* definition = context_.only(Kind::camera, context_.options.camera);
    if (!definition) {
        context_.diagnostics
            .error("E0601", context_.tree.header.span,
                   context_.options.camera.empty() ? std::string("the scene has no camera")
                                                   : fmt::format("no camera is named `{}`", context_.options.camera))
            .help = "add one, for example `camera { from 0 1 4; look-at 0 0.5 0; exposure auto }`";
        return;
    }
    built.cameraSpan = definition->span;
    const auto bindInto = context_.binder(*definition, context_.diagnostics);
    if (!definition->type) {
        bindInto(nullptr);
        return;
    }
    CameraContext camera = contextOf(*definition);
    camera.pose = context_.options.cameraPose;
    auto placed = makerOf<MakeCamera>(*definition->type)(bindInto, camera, context_.diagnostics);
    if (!placed) return;
    built.scene.camera = std::move(placed->camera);
    built.scene.frame = {0, 0, camera.filmSize.x, camera.filmSize.y};
    built.scene.origin = placed->origin;
    built.cameraPose = camera.pose.value_or(poseOf(*placed, context_.up()));
    built.cameraExposure = placed->exposure;
    built.exposure = placed->exposure.factor();
    const Shutter& shutter = placed->shutter;
    built.shutter = {shutter.open, shutter.duration()};
    if (placed->toWorld.moves() || shutter.opening + shutter.closing > 0)
        built.scene.camera = std::make_unique<ShutterCamera>(
            std::move(built.scene.camera), placed->toWorld.then(Transform::translate(-placed->origin)), shutter);
    if (context_.reuse) keepOrigin();
    leaveOutEffects(*definition);
    if (built.scene.camera->disperses())
        context_.noteEffect(Effect::dispersion, definition->span, "the glass of its lens disperses");
    if (built.scene.camera->usesLens())
        context_.noteEffect(Effect::depthOfField, definition->span, "its lens has a width");
    if (placed->toWorld.moves() && built.shutter.duration > 0)
        context_.noteEffect(Effect::motion, definition->span, "the camera moves");
}

// Where the view is kept, geometry stays where it is, as far as single precision does not mind: the camera moves.
void CameraBuilder::keepOrigin() {
    SceneReuse& reuse = *context_.reuse;
    Scene& scene = context_.built.scene;
    const Vec3d place = reuse.origin ? scene.origin - *reuse.origin : Vec3d();
    if (reuse.keepsView() && length(place) > 0 && length(place) <= reuse.reach) {
        scene.origin = *reuse.origin;
        scene.camera = std::make_unique<MovedCamera>(std::move(scene.camera), place);
        scene.eye = Vec3(place);
        reuse.count().viewKept = true;
    }
    reuse.nextOrigin = scene.origin;
}

// Before anything is placed; the shutter of the scene is known.
void CameraBuilder::leaveOutEffects(const Definition& camera) {
    BuiltScene& built = context_.built;
    const bool centred =
        built.scene.camera->usesLens() && context_.leavesOut({SwitchedEffect::depthOfField}, camera.span);
    const bool still = context_.options.without.leavesOut(SwitchedEffect::motion);
    if (still) built.shutter = {built.shutter.open + built.shutter.duration / 2, 0};
    if (centred || still)
        built.scene.camera = std::make_unique<ReducedCamera>(std::move(built.scene.camera), centred, still);
}

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

namespace {

constexpr int kDirections = 256;

// Point i of a Fibonacci lattice on the sphere: equal areas along z, turned by the golden angle.
Vec3 evenDirection(int i) {
    const double z = 1 - (2 * i + 1) / static_cast<double>(kDirections);
    const double turn = i * kPiD * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    return Vec3(Vec3d{r * std::cos(turn), r * std::sin(turn), z});
}

bool seesLight(const Scene& scene, Vec3 from) {
    const Wavelengths daylight = Wavelengths::sample(0.5f);
    constexpr std::array<Vec2, 2> places = {Vec2{0.3f, 0.3f}, Vec2{0.7f, 0.6f}};
    for (const auto& light : scene.lights) {
        if (light->infinite()) continue;    // what surrounds everything is outside
        if (light->emission()) return true; // glowing air may be anywhere
        for (const Vec2 u : places)
            if (const auto sample = light->sample(Receiver(from), 0, u, daylight, 0))
                if (!scene.intersector->occluded(from, sample->p, 0)) return true;
    }
    return false;
}

} // namespace

const Material* darkBodyAroundCamera(const Scene& scene) {
    const Vec3 camera = scene.eye;
    const Material* body = nullptr;
    std::array<Vec3, kDirections> inside{};
    for (int i = 0; i < kDirections; ++i) {
        const Vec3 direction = evenDirection(i);
        SurfaceHit hit;
        if (!scene.intersector->intersect({camera, direction}, hit)) return nullptr;
        if (hit.light || !hit.material || !hit.material->isOpaque() || dot(hit.ng, direction) <= 0) return nullptr;
        if (body && hit.material != body) return nullptr;
        body = hit.material;
        inside[static_cast<std::size_t>(i)] = spawnOrigin(hit, -direction);
    }
    if (seesLight(scene, camera)) return nullptr;
    for (const Vec3 p : inside)
        if (seesLight(scene, p)) return nullptr;
    return body;
}

} // namespace abbe

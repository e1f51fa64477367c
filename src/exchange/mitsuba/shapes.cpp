#include "exchange/mitsuba/shapes.h"

#include "exchange/mitsuba/bsdfs.h"
#include "exchange/mitsuba/media.h"
#include "exchange/mitsuba/settings.h"
#include "exchange/shared/placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace abbe::exchange {

namespace {

constexpr int kMostNestedShapes = 32; // groups inside of groups

void writeShapeMaterial(SceneNode& node, const XmlObject* bsdf, const MaterialTraits& traits, bool closed,
                        MitsubaContext& ctx) {
    // Without a BSDF it is matte and grey.
    if (!bsdf && closed) {
        node.child("material").word("diffuse").child("reflectance").number(0.5);
        return;
    }
    SceneNode& material = node.child("material");
    const bool blackBehind = !closed && (!bsdf || traits.oneSided);
    SceneNode& front = blackBehind ? material.word("two-sided").child("front") : material;
    if (bsdf)
        front.name(materialOf(*bsdf, ctx).first);
    else
        front.word("diffuse").child("reflectance").number(0.5);
    if (blackBehind) material.child("back").word("diffuse").child("reflectance").number(0);
}

void convertGroup(const XmlObject& group, MitsubaContext& ctx) {
    std::string& name = ctx.groups[&group];
    if (!name.empty()) return;
    name = ctx.objectNames.take(group.id, "object");
    SceneNode object("object");
    object.name(name);
    const Bounds3d outer = std::exchange(ctx.bounds, {});
    for (const XmlObject* shape : group.objects("shape")) convertShape(*shape, &object, ctx);
    ctx.groupBounds[&group] = std::exchange(ctx.bounds, outer);
    warnOfUnused(group, ctx.import);
    if (object.children().empty()) { // an object holds something
        ctx.groups[&group] = "-";
        return;
    }
    ctx.import.nodes.push_back(std::move(object));
}

void convertInstance(const XmlObject& instance, SceneNode* parent, MitsubaContext& ctx) {
    const auto groups = instance.objects("shape");
    const Transform map = mitsubaTransform(instance);
    if (groups.empty() || groups[0]->plugin != "shapegroup") {
        ctx.import.diagnostics.error("E0802", instance.span, "an instance needs a `shapegroup`");
        return;
    }
    convertGroup(*groups[0], ctx);
    if (ctx.groups[groups[0]] == "-") return;
    SceneNode node("instance");
    node.name(ctx.groups[groups[0]]);
    writeTransform(node, map);
    if (parent)
        parent->adopt(std::move(node));
    else
        ctx.add(std::move(node));
    ctx.noteBounds(ctx.groupBounds[groups[0]], map);
    warnOfUnused(instance, ctx.import);
}

void leaveOutShape(const XmlObject& shape, MitsubaContext& ctx) {
    ctx.import.leftOut(nullptr, shape.span, fmt::format("shape `{}`", shape.plugin),
                       "the language has no shapes of this kind");
    for (const XmlParam& param : shape.params) param.used = true;
}

// What has no inside whatever its material.
bool isOpen(const XmlObject& shape) {
    constexpr std::array<std::string_view, 5> kOpen = {"rectangle", "disk", "cylinder", "bsplinecurve", "linearcurve"};
    return std::ranges::find(kOpen, shape.plugin) != kOpen.end();
}

// `ctx.bounds` are those of the shape, in the world unless it is part of an object.
void noteMedia(const XmlObject& shape, const MaterialTraits& traits, const ShapeMedia& media, bool isFilled,
               bool isPart, MitsubaContext& ctx) {
    FilledShape filled;
    filled.name = shape.id.empty() ? fmt::format("a `{}`", shape.plugin) : fmt::format("`{}`", shape.id);
    filled.span = shape.span;
    filled.surface = traits.boundary ? FilledShape::Surface::boundary
                     : traits.clear  ? FilledShape::Surface::dielectric
                                     : FilledShape::Surface::opaque;
    filled.inside = media.inside;
    filled.outside = media.outside;
    filled.isFilled = isFilled && filled.surface != FilledShape::Surface::opaque;
    if (!isPart) filled.box = ctx.bounds;
    ctx.nesting.note(std::move(filled));
}

void convertSurface(const XmlObject& shape, SceneNode* parent, MitsubaContext& ctx) {
    const auto bsdfs = shape.objects("bsdf");
    const XmlObject* const bsdf = bsdfs.empty() ? nullptr : bsdfs[0];
    MaterialTraits traits;
    if (bsdf) traits = materialOf(*bsdf, ctx).second;
    const auto emitters = shape.objects("emitter");
    for (const XmlObject* sensor : shape.objects("sensor"))
        ctx.import.leftOut(nullptr, sensor->span, fmt::format("sensor `{}` of a shape", sensor->plugin),
                           "cameras see radiance: a white `diffuse` surface in its place shows irradiance / π");
    // Voxels behind a surface that is none stand for themselves.
    const bool voxels = traits.boundary && !parent && emitters.empty() && gridVolumeOf(shape, ctx);
    const ShapeMedia media = mediaOf(shape, ctx);
    // A surface within one medium, which is there anyway, has nothing to say.
    const bool isWithin = media.inside && media.inside == media.outside && isAround(media.outside, ctx);
    std::string inside = voxels || !media.inside || isWithin
                             ? std::string()
                             : mediumOf(*media.inside, shape.find("interior")->span, ctx);
    SceneNode node("shape");
    node.name(ctx.shapeNames.take(shape.id, shape.plugin));
    if (!emitters.empty()) noteEmitterTextures(*emitters[0], traits);
    const Bounds3d others = std::exchange(ctx.bounds, {});
    const ShapeForm form = writeGeometry(node, shape, traits, ctx);
    if (!inside.empty() && isOpen(shape)) {
        ctx.import.leftOut(&node, shape.span, "`interior`", "an open surface has no inside: media fill closed shapes");
        inside.clear();
    }
    if (form.shown && media.isStated() && !isWithin)
        noteMedia(shape, traits, media, voxels || !inside.empty(), parent != nullptr, ctx);
    ctx.bounds.add(others);
    if (form.shown && traits.normalMap && form.turned)
        ctx.import.approximated(
            &node, shape.span, fmt::format("the normal map of `{}`", shape.plugin),
            "its y leans the other way, since texture coordinates of this shape are turned over here");
    if (form.shown && traits.boundary && inside.empty() && emitters.empty()) {
        warnOfUnused(shape, ctx.import);
        return; // nothing changes where it is
    }
    warnOfUnused(shape, ctx.import);
    if (!form.shown) return;
    writeShapeMaterial(node, bsdf, traits, form.closed, ctx);
    if (!inside.empty()) node.child("interior").name(inside);
    for (const XmlObject* emitter : emitters) writeShapeEmitter(node, *emitter, shape, ctx);
    if (parent)
        parent->adopt(std::move(node));
    else
        ctx.add(std::move(node));
}

// A second copy in the same place shows nothing new, and copies of copies would double at every level.
void convertMerged(const XmlObject& merged, SceneNode* parent, MitsubaContext& ctx) {
    if (!ctx.groups.emplace(&merged, "-").second) {
        ctx.import.leftOut(nullptr, merged.span, "a second copy of merged shapes", "the first is in the same place");
        return;
    }
    for (const XmlObject* inner : merged.objects("shape")) convertShape(*inner, parent, ctx);
    warnOfUnused(merged, ctx.import);
}

} // namespace

void convertShape(const XmlObject& shape, SceneNode* parent, MitsubaContext& ctx) {
    if (ctx.depth >= kMostNestedShapes) {
        ctx.import.diagnostics.error("E0802", shape.span,
                                     fmt::format("more than {} shapes inside of each other", kMostNestedShapes));
        return;
    }
    ++ctx.depth;
    if (shape.plugin == "shapegroup")
        convertGroup(shape, ctx);
    else if (shape.plugin == "instance")
        convertInstance(shape, parent, ctx);
    else if (shape.plugin == "merge")
        convertMerged(shape, parent, ctx);
    else
        convertSurface(shape, parent, ctx);
    --ctx.depth;
}

namespace {

void flipFaces(MeshData& mesh) {
    for (auto& q : mesh.quads) std::swap(q[1], q[3]);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    for (Vec3& n : mesh.normals) n = -n;
}

// Four corners of a side with their coordinates, as Mitsuba has them.
void addSide(MeshData& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d, std::span<const Vec2, 4> uvs) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3 p : {a, b, c, d}) mesh.positions.push_back(p);
    mesh.uvs.insert(mesh.uvs.end(), uvs.begin(), uvs.end());
    mesh.quads.push_back({first, first + 1, first + 2, first + 3});
}

MeshData rectangleMesh() {
    MeshData mesh;
    constexpr Vec2 kUvs[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    addSide(mesh, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, kUvs);
    return mesh;
}

MeshData cubeMesh() {
    MeshData mesh;
    constexpr Vec2 kUvs[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    addSide(mesh, {1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}, kUvs);
    addSide(mesh, {1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, kUvs);
    addSide(mesh, {1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}, kUvs);
    addSide(mesh, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}, kUvs);
    addSide(mesh, {-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}, kUvs);
    addSide(mesh, {1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}, kUvs);
    return mesh;
}

ShapeForm writeFlat(SceneNode& node, const XmlObject& shape, const MaterialTraits& traits, MitsubaContext& ctx) {
    const bool flip = mitsubaFlag(shape, "flip_normals", false, ctx.import);
    const bool cube = shape.plugin == "cube";
    if (!traits.textured && !flip) {
        constexpr double kSides[3] = {2, 2, 2};
        node.word(cube ? "box" : "quad").child("size").numbers(std::span(kSides, cube ? 3 : 2));
    } else {
        MeshData mesh = cube ? cubeMesh() : rectangleMesh();
        if (flip) flipFaces(mesh);
        turnCoordinates(mesh, traits);
        node.word("mesh");
        SceneNode &points = node.child("points"), &uvs = node.child("uvs"), &faces = node.child("faces");
        for (const Vec3 p : mesh.positions) points.child("-").vector(Vec3d(p));
        for (const Vec2 uv : mesh.uvs) uvs.child("-").number(uv.x).number(uv.y);
        for (const auto& q : mesh.quads) faces.child("-").number(q[0]).number(q[1]).number(q[2]).number(q[3]);
    }
    writeTransform(node, mitsubaTransform(shape));
    ctx.noteBounds({{-1, -1, cube ? -1.0 : 0.0}, {1, 1, cube ? 1.0 : 0.0}}, mitsubaTransform(shape));
    return {true, cube && !flip, true};
}

void leaveOutFlip(SceneNode& node, const XmlObject& shape, MitsubaContext& ctx) {
    if (mitsubaFlag(shape, "flip_normals", false, ctx.import))
        ctx.import.leftOut(&node, shape.span, fmt::format("`flip_normals` of `{}`", shape.plugin),
                           "the outside of round shapes is outside");
}

void noteRoundMap(SceneNode& node, const XmlObject& shape, const MaterialTraits& traits, MitsubaContext& ctx) {
    if (traits.textured && traits.toUv)
        ctx.import.leftOut(&node, shape.span, "`to_uv`",
                           fmt::format("textures cannot be scaled on a `{}`", shape.plugin));
}

ShapeForm writeSphere(SceneNode& node, const XmlObject& shape, const MaterialTraits& traits, MitsubaContext& ctx) {
    node.word("sphere");
    const Vec3d center = mitsubaVector(shape, "center", ctx.import).value_or(Vec3d());
    const double radius = mitsubaNumber(shape, "radius", 1, ctx.import);
    Transform map = mitsubaTransform(shape);
    leaveOutFlip(node, shape, ctx);
    noteRoundMap(node, shape, traits, ctx);
    if (!(radius > 0)) {
        ctx.import.diagnostics.error("E0802", shape.span, "a radius is above 0");
        return {};
    }
    const Vec3d half(radius, radius, radius);
    ctx.noteBounds({center - half, center + half}, map);
    if (traits.textured || traits.framed)
        // Mitsuba's pole is z, and longitude counts from x.
        map = axesTo({0, 1, 0}, {0, 0, 1}, {1, 0, 0}).then(Transform::translate(center)).then(map);
    else if (!(center == Vec3d()))
        node.child("center").vector(center);
    node.child("radius").number(radius);
    writeTransform(node, map);
    return {true, true};
}

ShapeForm writeDisk(SceneNode& node, const XmlObject& shape, const MaterialTraits& traits, MitsubaContext& ctx) {
    node.word("disk");
    const bool flip = mitsubaFlag(shape, "flip_normals", false, ctx.import);
    node.child("normal").vector({0, 0, flip ? -1.0 : 1.0});
    node.child("radius").number(1);
    noteRoundMap(node, shape, traits, ctx);
    const Transform map = mitsubaTransform(shape);
    ctx.noteBounds({{-1, -1, 0}, {1, 1, 0}}, map);
    // Its angle runs the other way round where v is turned over.
    writeTransform(node, traits.textured || traits.framed ? Transform::scale({1, -1, 1}).then(map) : map);
    return {true, false};
}

ShapeForm writeCylinder(SceneNode& node, const XmlObject& shape, const MaterialTraits& traits, MitsubaContext& ctx) {
    node.word("cylinder");
    const Vec3d p0 = mitsubaVector(shape, "p0", ctx.import).value_or(Vec3d());
    const Vec3d p1 = mitsubaVector(shape, "p1", ctx.import).value_or(Vec3d(0, 0, 1));
    const double radius = mitsubaNumber(shape, "radius", 1, ctx.import);
    leaveOutFlip(node, shape, ctx);
    noteRoundMap(node, shape, traits, ctx);
    const double height = length(p1 - p0);
    if (!(radius > 0) || !(height > 0)) {
        ctx.import.diagnostics.error("E0802", shape.span, "a cylinder has a radius and a length above 0");
        return {};
    }
    Transform map = mitsubaTransform(shape);
    const Vec3d around(radius, radius, radius);
    ctx.noteBounds({min(p0, p1) - around, max(p0, p1) + around}, map);
    if (traits.textured || traits.framed) {
        // Longitude counts from the first axis of the frame [Duff2017]; v grows from p0 to p1 there, and down here, so
        // that a mirror keeps the sense of the longitude.
        const Vec3d z = (p1 - p0) / height;
        const double sign = std::copysign(1.0, z.z), k = -1 / (sign + z.z), b = z.x * z.y * k;
        const Vec3d first(1 + sign * z.x * z.x * k, sign * b, -sign * z.x), second(b, sign + z.y * z.y * k, -z.y);
        map = axesTo(second, -z, first).then(Transform::translate((p0 + p1) * 0.5)).then(map);
    } else {
        node.child("center").vector((p0 + p1) * 0.5);
        node.child("axis").vector(p1 - p0);
    }
    node.child("radius").number(radius);
    node.child("height").number(height);
    node.child("caps").word("off");
    writeTransform(node, map);
    return {true, false};
}

} // namespace

void turnCoordinates(MeshData& mesh, const MaterialTraits& traits) {
    for (Vec2& uv : mesh.uvs) {
        const Vec3d at(uv.x, uv.y, 0);
        // A transform of the plane: its third row and column are not used.
        const Vec3d to = traits.toUv ? traits.toUv->point(at) : at;
        uv = {static_cast<float>(to.x), static_cast<float>(1 - to.y)};
    }
}

ShapeForm writeGeometry(SceneNode& node, const XmlObject& shape, const MaterialTraits& traits, MitsubaContext& ctx) {
    const std::string_view type = shape.plugin;
    mitsubaIgnore(shape, {"silhouette_sampling_weight", "id"});
    if (type == "rectangle" || type == "cube") return writeFlat(node, shape, traits, ctx);
    if (type == "sphere") return writeSphere(node, shape, traits, ctx);
    if (type == "disk") return writeDisk(node, shape, traits, ctx);
    if (type == "cylinder") return writeCylinder(node, shape, traits, ctx);
    if (type == "obj" || type == "ply" || type == "serialized") return writeMeshFile(node, shape, traits, ctx);
    if (type == "bsplinecurve" || type == "linearcurve") return writeCurves(node, shape, ctx);
    leaveOutShape(shape, ctx);
    return {};
}

} // namespace abbe::exchange

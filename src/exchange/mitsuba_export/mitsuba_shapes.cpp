#include "exchange/mitsuba_export/mitsuba_writer.h"
#include "exchange/shared/placement.h"
#include "exchange/shared/ply_writer.h"
#include "exchange/shared/scene_node.h"
#include "exchange/stated/stated_mesh.h"
#include "io/ply_points.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

void xmlVector(pugi::xml_node parent, const char* tag, const char* name, Vec3d v) {
    xmlValue(parent, tag, name, fmt::format("{} {} {}", numberText(v.x), numberText(v.y), numberText(v.z)));
}

Vec3d roundedVector(Vec3d v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

// One shape there: its node, whether its coordinates count, and where it is.
struct ShapeSite {
    pugi::xml_node parent;
    const Placed& placed;
    const StatedThing& thing;
    std::string id;
    bool framed;   // its texture coordinates count
    bool textured; // for a texture, and not for a highlight alone
    MitsubaWriter& w;

    pugi::xml_node node(std::string_view type) const { return xmlChild(parent, "shape", type, {}, id); }
};

using Nodes = std::vector<pugi::xml_node>;

// As a PLY file of triangles, in the space of `placed.toWorld` unless that is a mirror.
pugi::xml_node writePolygons(const ShapeSite& site, MeshData mesh) {
    const bool mirrored = site.placed.toWorld.determinant() < 0;
    if (mirrored) mesh = moved(std::move(mesh), site.placed.toWorld);
    splitQuads(mesh);
    const std::string stem = site.id.empty() ? site.thing.type : site.id;
    pugi::xml_node node = site.node("ply");
    xmlValue(node, "string", "filename", site.w.out.files.write(stem, "ply", binaryPly(mesh)));
    if (mesh.normals.empty()) xmlFlag(node, "face_normals", true);
    if (!mesh.uvs.empty()) xmlFlag(node, "flip_tex_coords", true);
    if (!mirrored) xmlTransform(node, site.placed.toWorld);
    return node;
}

pugi::xml_node writeRoundPolygons(const ShapeSite& site, std::string_view why) {
    site.w.out.approximated(site.thing.span, fmt::format("`{}`", site.thing.type), fmt::format("by polygons: {}", why));
    return writePolygons(site, *polygonsOf(site.thing, site.w.out.scene));
}

Nodes writeQuadShape(const ShapeSite& site) {
    const auto p = quadCorners(site.thing);
    if (length(p[0] + p[2] - p[1] - p[3]) > 1e-9 * length(p[2] - p[0]))
        return {writePolygons(site, *polygonsOf(site.thing, site.w.out.scene))};
    // The square from −1 to 1; where coordinates count, with v the other way round.
    Transform square = axesTo((p[1] - p[0]) * 0.5, (p[3] - p[0]) * 0.5, {0, 0, 1});
    if (site.thing.has("points")) {
        const Vec3d n = normalize(cross(p[1] - p[0], p[3] - p[0]));
        for (int r = 0; r < 3; ++r) square.a[r][2] = n[r];
    }
    square.t = (p[0] + p[2]) * 0.5;
    if (site.textured) square = Transform::scale({1, -1, 1}).then(square);
    pugi::xml_node node = site.node("rectangle");
    xmlTransform(node, square.then(site.placed.toWorld));
    return {node};
}

Nodes writeBoxShape(const ShapeSite& site) {
    if (site.textured || site.placed.toWorld.determinant() < 0)
        return {writePolygons(site, *polygonsOf(site.thing, site.w.out.scene))};
    const auto [lower, upper] = boxCorners(site.thing);
    pugi::xml_node node = site.node("cube");
    xmlTransform(node, Transform::scale((upper - lower) * 0.5)
                           .then(Transform::translate((lower + upper) * 0.5))
                           .then(site.placed.toWorld));
    return {node};
}

// Mitsuba's pole is z, and longitude counts from x.
Nodes writeSphereShape(const ShapeSite& site) {
    Transform map = site.placed.toWorld;
    const bool mirrored = map.determinant() < 0;
    if (!map.uniformScale() || (mirrored && site.framed))
        return {writeRoundPolygons(site, "Mitsuba's spheres are round and not mirrored")};
    const Vec3d center = site.thing.vector("center").value_or(Vec3d());
    if (mirrored) // it looks the same in a mirror through its centre
        map = Transform::translate(-center)
                  .then(Transform::scale({-1, 1, 1}))
                  .then(Transform::translate(center))
                  .then(map);
    pugi::xml_node node = site.node("sphere");
    if (site.framed)
        map = axesTo({0, 0, 1}, {1, 0, 0}, {0, 1, 0}).then(Transform::translate(center)).then(map);
    else if (!(center == Vec3d()))
        xmlVector(node, "point", "center", center);
    xmlNumber(node, "radius", site.thing.number("radius", 0.5));
    xmlTransform(node, map);
    return {node};
}

// The unit circle in the plane of x and y to the disk; a disk that faces −z is one turned over.
Transform circleTo(Vec3d center, Vec3d normal, double radius) {
    const Vec3d n = normalize(normal);
    const Transform size = Transform::scale({radius, radius, 1});
    if (n == Vec3d(0, 0, 1)) return size.then(Transform::translate(center));
    const Transform up = uprightTo({}, n);
    return size.then(axesTo(up.vector({1, 0, 0}), up.vector({0, 0, -1}), n)).then(Transform::translate(center));
}

pugi::xml_node writeDiskNode(const ShapeSite& site, std::string_view id, Vec3d center, Vec3d normal, double radius) {
    pugi::xml_node node = xmlChild(site.parent, "shape", "disk", {}, id);
    const bool down = normalize(normal) == Vec3d(0, 0, -1);
    Transform map = circleTo(center, down ? Vec3d(0, 0, 1) : normal, radius);
    if (site.framed) map = Transform::scale({1, -1, 1}).then(map);
    xmlTransform(node, map.then(site.placed.toWorld));
    if (down) xmlFlag(node, "flip_normals", true);
    return node;
}

Nodes writeDiskShape(const ShapeSite& site) {
    const Vec3d normal = site.thing.vector("normal").value_or(
        site.thing.kind == schema::Kind::light ? Vec3d(0, 0, 1) : site.w.out.scene.up());
    return {writeDiskNode(site, site.id, site.thing.vector("center").value_or(Vec3d()), normal,
                          site.thing.number("radius", 0.5))};
}

Nodes writeCylinderShape(const ShapeSite& site) {
    const StatedThing& thing = site.thing;
    if (!site.placed.toWorld.uniformScale() || site.framed)
        return {writeRoundPolygons(site, site.framed ? "its texture coordinates are others there"
                                                     : "Mitsuba's cylinders are round")};
    const Vec3d center = thing.vector("center").value_or(Vec3d());
    const Vec3d axis = normalize(thing.vector("axis").value_or(site.w.out.scene.up()));
    const double radius = thing.number("radius", 0.5), half = thing.number("height", 1) / 2;
    pugi::xml_node node = site.node("cylinder");
    const Transform& map = site.placed.toWorld;
    const bool mirrored = map.determinant() < 0; // then it is placed without a transform
    const auto end = [&](Vec3d p) { return roundedVector(mirrored ? map.point(p) : p); };
    xmlVector(node, "point", "p0", end(center - axis * half));
    xmlVector(node, "point", "p1", end(center + axis * half));
    xmlNumber(node, "radius", mirrored ? rounded(radius * *map.uniformScale()) : radius);
    if (!mirrored) xmlTransform(node, map);
    if (thing.word("caps") == "off") return {node};
    return {node, writeDiskNode(site, site.w.takeId(site.id + "-top", {}), center + axis * half, axis, radius),
            writeDiskNode(site, site.w.takeId(site.id + "-bottom", {}), center - axis * half, -axis, radius)};
}

Nodes writeFarShape(const ShapeSite& site) {
    site.w.out.approximated(site.thing.span, "`plane`", "by a square of 20 km");
    return {writePolygons(site, *polygonsOf(site.thing, site.w.out.scene))};
}

Nodes writePolygonShape(const ShapeSite& site) { return {writeRoundPolygons(site, "Mitsuba lacks the shape")}; }

struct StrandList {
    std::vector<Vec3d> points; // m, those of one strand after the other
    std::vector<double> radii; // m
    std::vector<std::size_t> counts;
};

StrandList strandsOf(const StatedThing& thing, double unit) {
    StrandList list;
    if (const std::string file = thing.word("file"); !file.empty()) {
        const PointFile read = readPlyPoints(file);
        for (std::size_t i = 0; i < read.positions.size(); ++i) {
            const std::size_t at = read.strandPoints.empty() ? i : read.strandPoints[i];
            list.points.push_back(Vec3d(read.positions[at]) * unit);
            if (!read.radii.empty()) list.radii.push_back(static_cast<double>(read.radii[at]) * unit);
        }
        list.counts.assign(read.strandSizes.begin(), read.strandSizes.end());
    } else if (const auto* points = thing.value<std::vector<Vec3d>>("points")) {
        list.points = *points;
    }
    if (const auto radius = thing.number("radius")) list.radii.assign(list.points.size(), *radius);
    if (const auto* radii = thing.value<std::vector<double>>("radii")) list.radii = *radii;
    if (const auto* counts = thing.value<std::vector<double>>("counts")) {
        list.counts.clear();
        for (const double count : *counts) list.counts.push_back(static_cast<std::size_t>(count));
    }
    if (list.counts.empty()) list.counts = {list.points.size()};
    return list;
}

// Lines of x y z radius; an empty line ends a strand.
Nodes writeStrands(const ShapeSite& site) {
    const StatedThing& thing = site.thing;
    const std::string basis = thing.word("basis");
    if (basis != "bspline" && basis != "linear") {
        site.w.out.leftOut(thing.span, fmt::format("`curves` of basis `{}`", basis),
                           "Mitsuba has B-splines and straight ones");
        for (const auto& unused : thing.takeUnused()) thing.has(unused.property);
        return {};
    }
    const StrandList list = strandsOf(thing, site.w.out.scene.unit(thing.span));
    std::string text;
    std::size_t at = 0;
    for (const std::size_t count : list.counts) {
        for (std::size_t i = 0; i < count && at < list.points.size(); ++i, ++at) {
            const Vec3d p = list.points[at];
            const double radius = at < list.radii.size() ? list.radii[at] : 0.001;
            text += fmt::format("{} {} {} {}\n", numberText(p.x), numberText(p.y), numberText(p.z), numberText(radius));
        }
        text += "\n";
    }
    if (thing.word("form") == "flat") site.w.out.approximated(thing.span, "flat curves", "they are tubes");
    pugi::xml_node node = site.node(basis == "bspline" ? "bsplinecurve" : "linearcurve");
    xmlValue(node, "string", "filename", site.w.out.files.write(site.id, "txt", text));
    xmlTransform(node, site.placed.toWorld);
    return {node};
}

// A square with the coordinates that a rectangle has there, as importers write it; nothing for other meshes.
std::optional<Transform> squareOf(const MeshData& mesh) {
    constexpr Vec2 kUvs[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    const bool one = mesh.positions.size() == 4 && mesh.normals.empty() && mesh.triangles.empty() &&
                     mesh.quads == std::vector<std::array<std::uint32_t, 4>>{{0, 1, 2, 3}};
    if (!one || !std::ranges::equal(mesh.uvs, kUvs)) return std::nullopt;
    const Vec3d a(mesh.positions[0]), b(mesh.positions[1]), c(mesh.positions[2]), d(mesh.positions[3]);
    const Vec3d n = cross(b - a, d - a);
    if (!(a + c == b + d) || !(lengthSquared(n) > 0)) return std::nullopt;
    Transform square = axesTo((b - a) * 0.5, (d - a) * 0.5, normalize(n));
    square.t = (a + c) * 0.5;
    return square;
}

// The file itself, where Mitsuba reads it as it is.
Nodes writeMeshNode(const ShapeSite& site) {
    auto mesh = meshOf(site.thing, site.w.out.scene);
    if (!mesh) return {};
    if (site.thing.type == "subdivision") {
        site.w.out.approximated(site.thing.span, "`subdivision`",
                                "by its cage: Mitsuba neither smooths nor displaces it");
        ignoreCage(site.thing);
    }
    const Transform& map = site.placed.toWorld;
    if (const auto square = mesh->file.empty() ? squareOf(mesh->mesh) : std::nullopt) {
        pugi::xml_node node = site.node("rectangle");
        xmlTransform(node, square->then(map));
        return {node};
    }
    const bool asItIs =
        !mesh->file.empty() && mesh->mesh.quads.empty() && map.determinant() > 0 && site.thing.type == "mesh";
    if (!asItIs) return {writePolygons(site, std::move(mesh->mesh))};
    pugi::xml_node node = site.node(mesh->obj ? "obj" : "ply");
    xmlValue(node, "string", "filename", site.w.out.files.refer(mesh->file));
    if (mesh->mesh.normals.empty()) xmlFlag(node, "face_normals", true);
    if (!mesh->obj && !mesh->mesh.uvs.empty()) xmlFlag(node, "flip_tex_coords", true);
    const double unit = site.w.out.scene.unit(site.thing.span);
    xmlTransform(node, unit == 1 ? map : Transform::scale({unit, unit, unit}).then(map));
    return {node};
}

struct ShapeRow {
    std::string_view type;
    Nodes (*write)(const ShapeSite&);
};

constexpr ShapeRow kShapes[] = {
    {"quad", writeQuadShape},       {"box", writeBoxShape},           {"sphere", writeSphereShape},
    {"disk", writeDiskShape},       {"cylinder", writeCylinderShape}, {"plane", writeFarShape},
    {"cone", writePolygonShape},    {"torus", writePolygonShape},     {"mesh", writeMeshNode},
    {"subdivision", writeMeshNode}, {"curves", writeStrands},
};

// A whole sphere or box, and the camera is not in it: what is inside of it is not seen.
bool isSeenFromOutside(const Placed& placed, const MitsubaWriter& w) {
    const StatedThing& thing = *placed.thing;
    const auto& cameras = w.out.scene.cameras();
    if (cameras.empty() || (thing.type != "sphere" && thing.type != "box")) return false;
    const auto back = placed.toWorld.inverse();
    if (!back) return false;
    return std::ranges::all_of(cameras, [&](const StatedThing* camera) {
        const Vec3d eye = back->point(cameraToWorld(*camera, w.out.scene).t);
        if (thing.type == "sphere")
            return length(eye - thing.vector("center").value_or(Vec3d())) > thing.number("radius", 0.5);
        const auto [lower, upper] = boxCorners(thing);
        return minComponent(eye - lower) < 0 || minComponent(upper - eye) < 0;
    });
}

// What is the same for a shape's parts: material, interior, emission.
void finishShape(pugi::xml_node node, const Placed& placed, const StatedThing* material, MitsubaWriter& w) {
    const bool parentIsWorld = node.parent() == w.body;
    const StatedThing& thing = *placed.thing;
    writeMitsubaMaterial(node, material, parentIsWorld && isSeenFromOutside(placed, w), w);
    if (const StatedThing* medium = thing.reference("interior"))
        writeMitsubaMedium(node, *medium, w);
    else
        writeMitsubaAbsorption(node, material, w);
    if (const StatedSpectrum emission = thing.spectrum("emission"))
        writeMitsubaColor(xmlChild(node, "emitter", "area"), "radiance", emission, w.exposure, w);
    w.remark(node);
}

void writeSurface(pugi::xml_node parent, const Placed& placed, MitsubaWriter& w) {
    const StatedThing& thing = *placed.thing;
    const auto row = std::ranges::find(kShapes, std::string_view(thing.type), &ShapeRow::type);
    if (row == std::end(kShapes)) {
        w.out.leftOut(thing.span, fmt::format("shape `{}`", thing.type), "Mitsuba has nothing like it");
        return;
    }
    const StatedThing* const material = thing.reference("material");
    const bool shows = thing.spectrum("emission").texture != nullptr;
    const bool framed = (material && material->usesCoordinates(true)) || shows;
    const bool textured = (material && material->usesCoordinates(false)) || shows;
    const ShapeSite site{parent, placed, thing, w.takeId(thing.name, thing.type), framed, textured, w};
    if (thing.has("at")) w.out.approximated(thing.span, "a shape that deforms", "by what it is first");
    for (pugi::xml_node node : row->write(site)) finishShape(node, placed, material, w);
    if (thing.type == "mesh")
        if (const auto mesh = meshOf(thing, w.out.scene))
            for (const StatedMesh::Part& part : mesh->parts) {
                const ShapeSite one{parent, placed,   thing, w.takeId(site.id + "-" + part.group, {}),
                                    framed, textured, w};
                if (!part.mesh.triangles.empty() || !part.mesh.quads.empty())
                    finishShape(writePolygons(one, part.mesh), placed, part.material, w);
            }
    w.out.leaveOutUnused(thing);
}

void writeInstance(pugi::xml_node parent, const Placed& placed, MitsubaWriter& w) {
    const auto& inside = w.out.scene.object(placed.object);
    if (!canBeInstanced(inside)) {
        for (const Placed& part : unfolded(placed, w.out.scene)) writeMitsubaShape(parent, part, w);
        return;
    }
    std::string& id = w.groups[placed.object];
    if (id.empty()) {
        id = w.takeId(placed.object, {});
        pugi::xml_node group = xmlChild(w.root, "shape", "shapegroup", {}, id);
        for (const Placed& part : inside) writeSurface(group, part, w);
    }
    pugi::xml_node node = xmlChild(parent, "shape", "instance");
    node.append_child("ref").append_attribute("id") = id.c_str();
    xmlTransform(node, placed.toWorld);
}

// A black surface that emits.
void writeSurfaceLight(pugi::xml_node parent, const Placed& placed, MitsubaWriter& w) {
    const StatedThing& light = *placed.thing;
    const auto row = std::ranges::find(kShapes, std::string_view(light.type), &ShapeRow::type);
    double area = 0;
    if (light.type == "mesh") {
        if (const auto mesh = meshOf(light, w.out.scene)) area = areaOf(mesh->mesh, placed.toWorld);
    } else if (light.type == "quad") {
        area = areaOf(*polygonsOf(light, w.out.scene), placed.toWorld);
    } else {
        const double r = light.number("radius", 0.5) * placed.toWorld.uniformScale().value_or(1);
        area = (light.type == "sphere" ? 4 : 1) * kPiD * r * r;
    }
    const bool both = light.word("two-sided") == "on";
    const auto stated = statedLight(light, {.power = kPiD * area * (both ? 2 : 1)}, w.out.scene);
    const StatedSpectrum pattern = light.spectrum("radiance");
    if (light.has("texture")) w.out.leftOut(light.span, "the `texture` of a light", "the light is even there");
    const std::string id = w.takeId(light.name, light.type + "-light");
    for (const bool back : {false, true}) {
        if (back && !both) break;
        Placed side = placed;
        const ShapeSite site{parent,
                             side,
                             light,
                             back ? w.takeId(id + "-back", {}) : id,
                             pattern.texture != nullptr,
                             pattern.texture != nullptr,
                             w};
        for (pugi::xml_node node : row->write(site)) {
            if (back) xmlFlag(node, "flip_normals", true);
            xmlValue(xmlChild(node, "bsdf", "diffuse"), "spectrum", "reflectance", "0");
            pugi::xml_node emitter = xmlChild(node, "emitter", "area");
            if (pattern.texture)
                writeMitsubaColor(emitter, "radiance", pattern, w.exposure, w);
            else if (stated)
                xmlSpectrum(emitter, "radiance", plainSpectrum(*stated->curve, stated->scale * w.exposure));
            w.remark(node);
        }
    }
    w.out.leaveOutUnused(light);
}

} // namespace

void writeMitsubaShape(pugi::xml_node parent, const Placed& placed, MitsubaWriter& w) {
    if (placed.moves) w.out.approximated(placed.span, "what moves", "it stands where it is when the shutter opens");
    if (!placed.thing) return writeInstance(parent, placed, w);
    const StatedThing& thing = *placed.thing;
    if (thing.kind == schema::Kind::volume) {
        w.out.leftOut(thing.span, fmt::format("volume `{}`", thing.type),
                      "voxels and noise are not written for Mitsuba");
        return;
    }
    if (thing.kind == schema::Kind::instances) {
        w.out.leftOut(thing.span, "`instances`",
                      "places that are computed are not written for Mitsuba; state each as an `instance`");
        return;
    }
    const bool light = thing.kind == schema::Kind::light;
    if (!placed.visibleTo.empty() && !(w.hidesLights && (light || thing.spectrum("emission"))))
        w.out.leftOut(placed.span, "`visible-to`",
                      light ? "Mitsuba hides all lights from the camera or none"
                            : "every ray sees every shape in Mitsuba");
    if (light) {
        const bool surface =
            thing.type == "quad" || thing.type == "disk" || thing.type == "sphere" || thing.type == "mesh";
        return surface ? writeSurfaceLight(parent, placed, w) : writeMitsubaLight(parent, placed, w);
    }
    writeSurface(parent, placed, w);
}

} // namespace abbe::exchange

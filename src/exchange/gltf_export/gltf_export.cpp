#include "exchange/gltf_export/gltf_writer.h"
#include "exchange/stated/stated_mesh.h"
#include "exchange/stated/stated_spectra.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace abbe::exchange {

static_assert(std::endian::native == std::endian::little);

std::size_t GltfWriter::add(const char* list, GltfJson item) {
    GltfJson& all = document[list];
    all.push_back(std::move(item));
    return all.size() - 1;
}

std::size_t GltfWriter::addView(std::string_view bytes, int target) {
    while (buffer.size() % 4 != 0) buffer += '\0';
    GltfJson view = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    buffer += bytes;
    return add("bufferViews", std::move(view));
}

GltfJson gltfMatrix(const Transform& m) {
    GltfJson list = GltfJson::array();
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) list.push_back(m.a[r][c]);
        list.push_back(0);
    }
    for (int r = 0; r < 3; ++r) list.push_back(m.t[r]);
    list.push_back(1);
    return list;
}

namespace {

constexpr int kFloat = 5126, kUnsignedInt = 5125, kVertices = 34962, kIndices = 34963;

template <typename T> std::string_view bytesOf(const std::vector<T>& list) {
    return {reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T)};
}

template <typename T>
std::size_t accessorOf(const std::vector<T>& list, int component, const char* type, int target, GltfWriter& w) {
    return w.add("accessors", {{"bufferView", w.addView(bytesOf(list), target)},
                               {"componentType", component},
                               {"count", list.size()},
                               {"type", type}});
}

struct Packed3 {
    float x, y, z;
};

std::size_t vectorsOf(const std::vector<Vec3>& list, GltfWriter& w, bool bounds) {
    std::vector<Packed3> packed;
    Vec3 lower = list[0], upper = list[0];
    for (const Vec3 v : list) {
        packed.push_back({v.x, v.y, v.z});
        lower = min(lower, v);
        upper = max(upper, v);
    }
    const std::size_t at = accessorOf(packed, kFloat, "VEC3", kVertices, w);
    if (bounds) {
        w.document["accessors"][at]["min"] = {lower.x, lower.y, lower.z};
        w.document["accessors"][at]["max"] = {upper.x, upper.y, upper.z};
    }
    return at;
}

// ---- what stands in the scene

GltfJson nodeOf(const std::string& name, const Transform& map) {
    GltfJson node = GltfJson::object();
    if (!name.empty()) node["name"] = name;
    bool same = map.t == Vec3d();
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) same = same && map.a[r][c] == (r == c ? 1 : 0);
    if (!same) node["matrix"] = gltfMatrix(map);
    return node;
}

std::optional<MeshData> trianglesOf(const StatedThing& thing, GltfWriter& w) {
    std::optional<MeshData> mesh;
    if (thing.type == "mesh" || thing.type == "subdivision") {
        if (auto stated = meshOf(thing, w.out.scene)) mesh = std::move(stated->mesh);
        if (thing.type == "subdivision") {
            w.out.approximated(thing.span, "`subdivision`", "by its cage, neither smooth nor displaced");
            ignoreCage(thing);
        }
        if (thing.has("at")) w.out.approximated(thing.span, "a shape that deforms", "by what it is first");
    } else {
        mesh = polygonsOf(thing, w.out.scene);
        if (mesh && isRound(thing))
            w.out.approximated(thing.span, fmt::format("`{}`", thing.type), "by polygons: glTF has triangles alone");
        if (thing.type == "plane") w.out.approximated(thing.span, "`plane`", "by a square of 20 km");
    }
    return mesh;
}

// Light of a surface in nits, as a colour.
Vec3d nitsOf(const StatedThing& thing, const Transform& toWorld, GltfWriter& w) {
    const bool light = thing.kind == schema::Kind::light;
    std::optional<StatedLight> stated;
    if (!light) {
        const StatedSpectrum own = thing.spectrum("emission");
        if (own.texture) w.out.leftOut(thing.span, "the texture of a light", "the light is even there");
        if (own.curve) stated = StatedLight{own.curve, 1};
    } else {
        double area = 0;
        if (const auto mesh = trianglesOf(thing, w)) area = areaOf(*mesh, toWorld);
        stated = statedLight(thing, {.power = kPiD * area, .units = exactUnits()}, w.out.scene);
    }
    return stated ? rgbOf(*stated->curve, w.out.scene.daylight()) * (stated->scale * kUnitLuminance) : Vec3d();
}

// The nodes of a surface: one, and one for every part of a mesh with a material of its own.
std::vector<std::size_t> surfaceNodes(const Placed& placed, GltfWriter& w) {
    const StatedThing& thing = *placed.thing;
    auto mesh = trianglesOf(thing, w);
    std::vector<std::size_t> nodes;
    if (!mesh) {
        w.out.leftOut(thing.span, fmt::format("shape `{}`", thing.type), "glTF has nothing like it");
        return nodes;
    }
    const bool shines = thing.kind == schema::Kind::light || thing.spectrum("emission");
    const StatedThing* const stated = thing.kind == schema::Kind::light ? nullptr : thing.reference("material");
    const auto put = [&](MeshData part, std::optional<std::size_t> material) {
        if (part.triangles.empty() && part.quads.empty()) return;
        GltfJson node = nodeOf(thing.name, placed.toWorld);
        node["mesh"] = gltfMesh(std::move(part), thing.name, material, w);
        nodes.push_back(w.add("nodes", std::move(node)));
    };
    std::optional<std::size_t> material;
    if (shines)
        material = gltfLamp(thing, nitsOf(thing, placed.toWorld, w), w);
    else if (stated && stated->type == "boundary")
        w.out.leftOut(thing.span, "a `boundary`", "glTF has no media");
    else if (stated)
        material = gltfMaterial(*stated, w);
    if (!(stated && stated->type == "boundary")) put(std::move(*mesh), material);
    if (thing.type == "mesh" && !shines)
        if (const auto parts = meshOf(thing, w.out.scene))
            for (const StatedMesh::Part& part : parts->parts)
                put(part.mesh, part.material ? std::optional(gltfMaterial(*part.material, w)) : std::nullopt);
    w.out.leaveOutUnused(thing);
    return nodes;
}

// ---- lights and cameras

// A colour of at most 1 and the amount that goes with it: their product has the luminance.
void addAmount(GltfJson& light, const StatedLight& stated, GltfWriter& w) {
    const Vec3d rgb = rgbOf(*stated.curve, w.out.scene.daylight()) * (stated.scale * kUnitLuminance);
    const double most = std::max(1e-30, maxComponent(rgb));
    light["color"] = {rounded(rgb.x / most), rounded(rgb.y / most), rounded(rgb.z / most)};
    light["intensity"] = rounded(most);
}

std::optional<std::size_t> lightNode(const Placed& placed, GltfWriter& w) {
    const StatedThing& thing = *placed.thing;
    const StatedScene& scene = w.out.scene;
    GltfJson light;
    if (!thing.name.empty()) light["name"] = thing.name;
    Transform map;
    std::optional<StatedLight> stated;
    // They shine along −z.
    const auto along = [](Vec3d at, Vec3d axis) { return mapToAxis(at, -normalize(axis)); };
    if (thing.type == "point") {
        light["type"] = "point";
        stated = statedLight(thing, {.power = 4 * kPiD, .units = exactUnits()}, scene);
        map = Transform::translate(placed.toWorld.point(thing.vector("position").value_or(Vec3d())));
    } else if (thing.type == "spot") {
        const double angle = thing.number("angle", 45 * kDegree), inner = thing.number("inner-angle", 0.8 * angle);
        light["type"] = "spot";
        const double mean = kPiD * ((1 - std::cos(angle / 2)) + (1 - std::cos(inner / 2)));
        stated = statedLight(thing, {.power = mean, .units = exactUnits()}, scene);
        light["spot"] = {{"innerConeAngle", rounded(std::min(inner / 2, angle / 2 * 0.9999))},
                         {"outerConeAngle", rounded(std::min(angle / 2, kPiD / 2))}};
        const auto [at, axis] = axisOfLight(placed, thing);
        map = along(at, axis);
        w.out.approximated(thing.span, "the edge of `spot`", "it has another falloff in glTF");
    } else if (thing.type == "sun") {
        light["type"] = "directional";
        stated = statedSun(thing, w.out, exactUnits());
        map = along({}, sunToward(placed, thing, scene));
    } else {
        w.out.leftOut(thing.span, fmt::format("light `{}`", thing.type), "glTF has nothing like it");
        return std::nullopt;
    }
    if (stated) addAmount(light, *stated, w);
    w.out.leaveOutUnused(thing);
    w.extensions.insert("KHR_lights_punctual");
    GltfJson& lights = w.document["extensions"]["KHR_lights_punctual"]["lights"];
    lights.push_back(std::move(light));
    GltfJson node = nodeOf(thing.name, map);
    node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
    return w.add("nodes", std::move(node));
}

std::optional<std::size_t> cameraNode(const StatedThing& camera, GltfWriter& w) {
    const Vec2d size = filmSizeOf(w.out.scene);
    const double half = halfWidthOf(camera, size), tall = half * size.y / size.x;
    GltfJson json;
    if (!camera.name.empty()) json["name"] = camera.name;
    json["type"] = camera.type;
    if (camera.type == "perspective") {
        json["perspective"] = {
            {"aspectRatio", size.x / size.y}, {"yfov", rounded(2 * std::atan(tall))}, {"znear", 0.001}};
    } else if (camera.type == "orthographic") {
        json["orthographic"] = {{"xmag", half}, {"ymag", tall}, {"znear", 0.001}, {"zfar", 100000}};
    } else {
        w.out.leftOut(camera.span, fmt::format("camera `{}`", camera.type), "glTF has none like it");
        return std::nullopt;
    }
    if (lensRadiusOf(camera) > 0) w.out.leftOut(camera.span, "the lens of a camera", "all is sharp in glTF");
    Export::ignore(camera, {"focus", "f-stop", "aperture", "sensor", "lens", "fov", "squeeze", "look-at", "from", "up",
                            "at", "time", "shutter", "width", "height", "transform"});
    w.out.leaveOutUnused(camera);
    GltfJson node = nodeOf(camera.name.empty() ? "camera" : camera.name, cameraToWorld(camera, w.out.scene));
    node["camera"] = w.add("cameras", std::move(json));
    return w.add("nodes", std::move(node));
}

bool isSurface(const StatedThing& thing) {
    return thing.kind == schema::Kind::shape ||
           (thing.kind == schema::Kind::light &&
            (thing.type == "quad" || thing.type == "disk" || thing.type == "sphere" || thing.type == "mesh"));
}

// Instances of an object share its meshes: their nodes are copies of the object's, each below a node of its own.
void placedNodes(const Placed& placed, std::vector<std::size_t>& roots, GltfWriter& w) {
    if (placed.moves) w.out.approximated(placed.span, "what moves", "it stands where it is when the shutter opens");
    if (!placed.thing) {
        for (const Placed& part : unfolded(placed, w.out.scene)) placedNodes(part, roots, w);
        return;
    }
    const StatedThing& thing = *placed.thing;
    if (!placed.visibleTo.empty()) w.out.leftOut(placed.span, "`visible-to`", "everything is seen in glTF");
    if (isSurface(thing)) {
        for (const std::size_t node : surfaceNodes(placed, w)) roots.push_back(node);
    } else if (thing.kind == schema::Kind::light) {
        if (const auto node = lightNode(placed, w)) roots.push_back(*node);
    } else {
        w.out.leftOut(thing.span, fmt::format("`{}` `{}`", schema::keyword(thing.kind), thing.type),
                      "glTF has nothing like it");
    }
}

std::string chunk(std::string bytes, std::uint32_t type, char pad) {
    while (bytes.size() % 4 != 0) bytes += pad;
    const std::uint32_t head[2] = {static_cast<std::uint32_t>(bytes.size()), type};
    return std::string(reinterpret_cast<const char*>(head), sizeof(head)) + bytes;
}

} // namespace

std::size_t gltfMesh(MeshData mesh, std::string_view name, std::optional<std::size_t> material, GltfWriter& w) {
    splitQuads(mesh);
    GltfJson primitive;
    primitive["attributes"]["POSITION"] = vectorsOf(mesh.positions, w, true);
    if (!mesh.normals.empty()) primitive["attributes"]["NORMAL"] = vectorsOf(mesh.normals, w, false);
    if (!mesh.uvs.empty()) { // v runs down there
        std::vector<std::array<float, 2>> uvs;
        for (const Vec2 uv : mesh.uvs) uvs.push_back({uv.x, 1 - uv.y});
        primitive["attributes"]["TEXCOORD_0"] = accessorOf(uvs, kFloat, "VEC2", kVertices, w);
    }
    std::vector<std::uint32_t> indices;
    for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
    primitive["indices"] = accessorOf(indices, kUnsignedInt, "SCALAR", kIndices, w);
    if (material) primitive["material"] = *material;
    GltfJson json;
    if (!name.empty()) json["name"] = name;
    json["primitives"] = GltfJson::array({primitive});
    return w.add("meshes", std::move(json));
}

std::string exportGltf(Export& to) {
    GltfWriter w(to);
    w.document["asset"] = {{"version", "2.0"}, {"generator", "abbe"}};
    std::vector<std::size_t> roots;
    for (const StatedThing* camera : to.scene.cameras())
        if (const auto node = cameraNode(*camera, w)) roots.push_back(*node);
    for (const Placed& placed : to.scene.placed()) placedNodes(placed, roots, w);
    if (to.scene.atmosphere()) to.leftOut(to.scene.atmosphere()->span, "`atmosphere`", "glTF has no media");
    if (to.scene.zUp()) { // one node turns all of it
        GltfJson turn = nodeOf("z-up", Transform::rotate({1, 0, 0}, -kPiD / 2));
        turn["children"] = roots;
        roots = {w.add("nodes", std::move(turn))};
    }
    w.document["scene"] = 0;
    w.document["scenes"] = GltfJson::array({{{"nodes", roots}}});
    if (roots.empty()) w.document["scenes"][0].erase("nodes");
    if (!w.extensions.empty()) w.document["extensionsUsed"] = w.extensions;
    if (!w.buffer.empty()) {
        while (w.buffer.size() % 4 != 0) w.buffer += '\0';
        w.document["buffers"] = GltfJson::array({{{"byteLength", w.buffer.size()}}});
    }
    constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942, kMagic = 0x46546C67;
    const std::string text = chunk(w.document.dump(-1, ' ', false, GltfJson::error_handler_t::replace), kJson, ' ');
    const std::string binary = w.buffer.empty() ? std::string() : chunk(w.buffer, kBinary, '\0');
    const std::uint32_t head[3] = {kMagic, 2, static_cast<std::uint32_t>(sizeof(head) + text.size() + binary.size())};
    return std::string(reinterpret_cast<const char*>(head), sizeof(head)) + text + binary;
}

} // namespace abbe::exchange

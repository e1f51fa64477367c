#include "exchange/stated/stated_mesh.h"

#include "exchange/shared/placement.h"
#include "io/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace abbe::exchange {

namespace {

constexpr int kAround = 96; // corners of a circle that becomes a polygon

// A ring of a surface of revolution about y.
struct Ring {
    double radius, height;
    Vec2d normal; // away from the axis, up
    double v;     // texture coordinate
};

// Rings from the bottom up, so that faces are counter-clockwise from outside; u grows from +z towards +x.
void revolve(MeshData& mesh, std::span<const Ring> rings) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Ring& ring : rings)
        for (int i = 0; i <= kAround; ++i) {
            const double u = static_cast<double>(i) / kAround;
            const double s = i % kAround == 0 ? 0 : std::sin(2 * kPiD * u),
                         c = i % kAround == 0 ? 1 : std::cos(2 * kPiD * u);
            mesh.positions.push_back(Vec3(Vec3d(ring.radius * s, ring.height, ring.radius * c)));
            mesh.normals.push_back(Vec3(Vec3d(ring.normal.x * s, ring.normal.y, ring.normal.x * c)));
            mesh.uvs.push_back({static_cast<float>(u), static_cast<float>(ring.v)});
        }
    constexpr std::uint32_t kRow = kAround + 1;
    for (std::uint32_t j = 0; j + 1 < rings.size(); ++j)
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const std::uint32_t a = first + j * kRow + i, b = a + 1, c = b + kRow, d = a + kRow;
            if (rings[j].radius == 0)
                mesh.triangles.push_back({a, c, d});
            else if (rings[j + 1].radius == 0)
                mesh.triangles.push_back({a, b, c});
            else
                mesh.quads.push_back({a, b, c, d});
        }
}

MeshData sphereMesh(double radius) {
    std::vector<Ring> rings;
    constexpr int kDown = kAround / 2;
    for (int i = 0; i <= kDown; ++i) {
        const double turn = kPiD * (static_cast<double>(i) / kDown - 0.5);
        const bool pole = i == 0 || i == kDown;
        const double c = pole ? 0 : std::cos(turn), s = pole ? std::copysign(1.0, turn) : std::sin(turn);
        rings.push_back({radius * c, radius * s, {c, s}, static_cast<double>(i) / kDown});
    }
    MeshData mesh;
    revolve(mesh, rings);
    return mesh;
}

MeshData frustumMesh(double bottom, double top, double height, bool caps) {
    const double h = height / 2, slope = (bottom - top) / height, l = std::hypot(1.0, slope);
    const Vec2d side(1 / l, slope / l);
    MeshData mesh;
    const Ring wall[] = {{bottom, -h, side, 0}, {top, h, side, 1}};
    revolve(mesh, wall);
    const Ring below[] = {{0, -h, {0, -1}, 0}, {bottom, -h, {0, -1}, 1}},
               above[] = {{top, h, {0, 1}, 0}, {0, h, {0, 1}, 1}};
    if (caps && bottom > 0) revolve(mesh, below);
    if (caps && top > 0) revolve(mesh, above);
    return mesh;
}

MeshData torusMesh(double ring, double tube) {
    std::vector<Ring> rings;
    constexpr int kTube = kAround / 2;
    for (int i = 0; i <= kTube; ++i) {
        // Up on the outer side.
        const double turn = 2 * kPiD * static_cast<double>(i % kTube) / kTube, c = std::cos(turn), s = std::sin(turn);
        rings.push_back({ring + tube * c, tube * s, {c, s}, static_cast<double>(i) / kTube});
    }
    MeshData mesh;
    revolve(mesh, rings);
    return mesh;
}

MeshData quadMesh(const std::vector<Vec3d>& corners) {
    MeshData mesh;
    for (const Vec3d p : corners) mesh.positions.push_back(Vec3(p));
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const std::uint32_t face[4] = {0, 1, 2, 3};
    addPolygon(mesh, face);
    return mesh;
}

// Every face has the whole square of texture coordinates, from its first corner on.
MeshData boxPolygons(Vec3d lower, Vec3d upper) {
    constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {5, 1, 3, 7}, {0, 1, 5, 4}, {6, 7, 3, 2}, {1, 0, 2, 3}, {4, 5, 7, 6}};
    MeshData mesh;
    for (const auto& face : kFaces) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const int i : face)
            mesh.positions.push_back(Vec3(Vec3d((i & 1) != 0 ? upper.x : lower.x, (i & 2) != 0 ? upper.y : lower.y,
                                                (i & 4) != 0 ? upper.z : lower.z)));
        for (const Vec2 uv : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) mesh.uvs.push_back(uv);
        mesh.quads.push_back({first, first + 1, first + 2, first + 3});
    }
    return mesh;
}

MeshData planeMesh() {
    constexpr double kFar = 10000; // m: beyond the horizon of most pictures
    MeshData mesh = quadMesh({{-kFar, 0, kFar}, {kFar, 0, kFar}, {kFar, 0, -kFar}, {-kFar, 0, -kFar}});
    for (std::size_t i = 0; i < 4; ++i) mesh.uvs[i] = {mesh.positions[i].x, -mesh.positions[i].z}; // in m
    return mesh;
}

MeshData discMesh(double radius) {
    MeshData mesh;
    const Ring rings[] = {{radius, 0, {0, 1}, 1}, {0, 0, {0, 1}, 0}};
    revolve(mesh, rings);
    mesh.uvs.clear(); // ours are polar
    return mesh;
}

// A mesh from the scene's own rows.
MeshData rowsOf(const StatedThing& thing, const std::vector<Vec3d>& points) {
    MeshData mesh;
    for (const Vec3d p : points) mesh.positions.push_back(Vec3(p));
    if (const auto* uvs = thing.value<std::vector<double>>("uvs"); uvs && uvs->size() == 2 * points.size())
        for (std::size_t i = 0; i < points.size(); ++i)
            mesh.uvs.push_back({static_cast<float>((*uvs)[2 * i]), static_cast<float>((*uvs)[2 * i + 1])});
    if (const auto* normals = thing.value<std::vector<Vec3d>>("normals"); normals && normals->size() == points.size())
        for (const Vec3d n : *normals) mesh.normals.push_back(Vec3(n));
    const auto* const faces = thing.value<schema::IndexRows>("faces");
    std::span<const std::uint32_t> left = faces ? std::span(faces->indices) : std::span<const std::uint32_t>();
    for (const std::uint32_t count : faces ? faces->counts : std::vector<std::uint32_t>()) {
        addPolygon(mesh, left.first(count));
        left = left.subspan(count);
    }
    if (const auto* all = thing.find("attribute"))
        for (const auto& one : *all)
            if (const auto* numbers = std::get_if<schema::NamedNumbers>(&one)) {
                MeshAttribute attribute{numbers->name, numbers->values.size() == points.size() ? 1 : 3, {}};
                for (const double v : numbers->values) attribute.values.push_back(static_cast<float>(v));
                mesh.attributes.push_back(std::move(attribute));
            }
    return mesh;
}

void append(MeshData& to, const MeshData& from) {
    const auto first = static_cast<std::uint32_t>(to.positions.size());
    to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
    to.normals.insert(to.normals.end(), from.normals.begin(), from.normals.end());
    to.uvs.insert(to.uvs.end(), from.uvs.begin(), from.uvs.end());
    for (auto t : from.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    for (auto q : from.quads) to.quads.push_back({q[0] + first, q[1] + first, q[2] + first, q[3] + first});
}

// Faces of groups with a material of their own, apart from the others.
void takeParts(StatedMesh& out, const MeshFile& read, const StatedThing& thing, const StatedScene& scene) {
    std::vector<std::string> names;
    for (const auto& group : read.groups) names.push_back(group.name);
    std::vector<bool> taken(names.size());
    for (const DressedGroups& one : dressedGroups(thing, names, scene)) {
        StatedMesh::Part part{one.group, {}, one.material};
        for (const std::size_t i : one.runs) {
            taken[i] = true;
            append(part.mesh, extractGroup(read, read.groups[i]));
        }
        out.parts.push_back(std::move(part));
    }
    if (out.parts.empty()) return;
    out.file.clear();
    out.mesh = {};
    for (std::size_t i = 0; i < read.groups.size(); ++i)
        if (!taken[i]) append(out.mesh, extractGroup(read, read.groups[i]));
}

} // namespace

std::vector<DressedGroups> dressedGroups(const StatedThing& thing, const std::vector<std::string>& names,
                                         const StatedScene& scene) {
    std::vector<DressedGroups> found;
    const auto* const materials = thing.find("material");
    if (!materials) return found;
    std::vector<bool> taken(names.size());
    for (const auto& value : *materials) {
        const auto* const one = std::get_if<schema::GroupReference>(&value);
        if (!one) continue;
        DressedGroups& dressed = found.emplace_back(DressedGroups{one->group, scene.thing(one->reference), {}});
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (names[i] != one->group || taken[i]) continue;
            taken[i] = true;
            dressed.runs.push_back(i);
        }
    }
    return found;
}

std::optional<StatedMesh> meshOf(const StatedThing& thing, const StatedScene& scene) {
    StatedMesh out;
    const auto* points = thing.value<std::vector<Vec3d>>("points");
    const auto* file = thing.value<schema::Text>("file");
    if (!points && !file) { // of a shape that deforms, as it is first
        points = thing.value<std::vector<Vec3d>>("at.points");
        file = thing.value<schema::Text>("at.file");
    }
    if (points) {
        out.mesh = rowsOf(thing, *points);
        return out;
    }
    if (!file) return std::nullopt;
    MeshFile read = readMesh(file->value);
    const bool gltf = read.coordinates == MeshCoordinates::metresYUp;
    if (!gltf) {
        out.file = file->value;
        out.obj = !readFileBytes(file->value).starts_with("ply");
        const double unit = scene.unit(thing.span);
        read.mesh = moved(std::move(read.mesh), Transform::scale({unit, unit, unit}));
    } else if (scene.zUp()) {
        read.mesh = moved(std::move(read.mesh), Transform::rotate({1, 0, 0}, kPiD / 2));
    }
    out.mesh = read.mesh;
    takeParts(out, read, thing, scene);
    return out;
}

void ignoreCage(const StatedThing& thing) {
    for (const char* property : {"scheme", "boundary", "texture-boundary", "creasing", "crease", "corner", "dicing",
                                 "offscreen", "memory", "uv-faces", "displacement", "displacement.map",
                                 "displacement.midpoint", "displacement.kind", "displacement.space"})
        thing.has(property);
}

std::vector<Vec3d> quadCorners(const StatedThing& thing) {
    if (const auto* points = thing.value<std::vector<Vec3d>>("points"); points && points->size() == 4) return *points;
    const Vec2d size = thing.pair("size").value_or(Vec2d(1, 1));
    const double w = size.x / 2, h = size.y / 2;
    return {{-w, -h, 0}, {w, -h, 0}, {w, h, 0}, {-w, h, 0}};
}

std::pair<Vec3d, Vec3d> boxCorners(const StatedThing& thing) {
    const auto lower = thing.vector("min"), upper = thing.vector("max");
    if (lower && upper) return {*lower, *upper};
    const Vec3d size = thing.vector("size").value_or(Vec3d(1, 1, 1));
    const Vec3d center = thing.vector("center").value_or(Vec3d());
    return {center - size * 0.5, center + size * 0.5};
}

Transform uprightTo(Vec3d place, Vec3d axis) {
    const Vec3d y = normalize(axis);
    const Vec3d x = normalize(cross(y, std::abs(y.z) < 0.9 ? Vec3d(0, 0, 1) : Vec3d(1, 0, 0)));
    return axesTo(x, y, cross(x, y), place);
}

bool isRound(const StatedThing& thing) {
    return thing.type != "quad" && thing.type != "box" && thing.type != "plane" && thing.type != "mesh";
}

std::optional<MeshData> polygonsOf(const StatedThing& thing, const StatedScene& scene) {
    const std::string& type = thing.type;
    const Vec3d center = thing.vector("center").value_or(Vec3d());
    if (type == "quad") return quadMesh(quadCorners(thing));
    if (type == "box") {
        const auto [lower, upper] = boxCorners(thing);
        return boxPolygons(lower, upper);
    }
    if (type == "sphere") return moved(sphereMesh(thing.number("radius", 0.5)), Transform::translate(center));
    const bool light = thing.kind == schema::Kind::light;
    if (type == "disk" || type == "plane") {
        const Vec3d normal = thing.vector("normal").value_or(light ? Vec3d(0, 0, 1) : scene.up());
        return moved(type == "disk" ? discMesh(thing.number("radius", 0.5)) : planeMesh(), uprightTo(center, normal));
    }
    const Transform upright = uprightTo(center, thing.vector("axis").value_or(scene.up()));
    const double radius = thing.number("radius", 0.5), height = thing.number("height", 1);
    const bool caps = thing.word("caps") != "off";
    if (type == "cylinder") return moved(frustumMesh(radius, radius, height, caps), upright);
    if (type == "cone") return moved(frustumMesh(radius, thing.number("top-radius", 0), height, caps), upright);
    if (type == "torus")
        return moved(torusMesh(thing.number("major-radius", 0.5), thing.number("minor-radius", 0.125)), upright);
    return std::nullopt;
}

MeshData moved(MeshData mesh, const Transform& map) {
    for (Vec3& p : mesh.positions) p = Vec3(map.point(Vec3d(p)));
    for (Vec3& n : mesh.normals)
        if (lengthSquared(n) > 0) n = Vec3(normalize(map.normal(Vec3d(n))));
    if (map.determinant() < 0) {
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
        for (auto& q : mesh.quads) std::swap(q[1], q[3]);
    }
    return mesh;
}

void splitQuads(MeshData& mesh) {
    for (const auto& q : mesh.quads) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    mesh.quads.clear();
}

double areaOf(const MeshData& mesh, const Transform& toWorld) {
    double sum = 0;
    const auto at = [&](std::uint32_t i) { return toWorld.point(Vec3d(mesh.positions[i])); };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        sum += length(cross(at(b) - at(a), at(c) - at(a))) / 2;
    };
    for (const auto& t : mesh.triangles) add(t[0], t[1], t[2]);
    for (const auto& q : mesh.quads) add(q[0], q[1], q[2]), add(q[0], q[2], q[3]);
    return sum;
}

} // namespace abbe::exchange

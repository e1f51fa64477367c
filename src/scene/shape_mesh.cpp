#include "scene/shape_mesh.h"

#include "geometry/mesh.h"
#include "geometry/shape_params.h"
#include "scene/file_faults.h"
#include "scene/shape_builder.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

// glTF states metres and y up; other formats say nothing and are taken as the scene's own.
void toScene(MeshFile& file, double unit, bool zUp) {
    const bool stated = file.coordinates == MeshCoordinates::metresYUp;
    const bool turn = stated && zUp;
    for (Vec3& p : file.mesh.positions) {
        if (turn) p = {p.x, -p.z, p.y};
        if (!stated) p = Vec3(Vec3d(p) * unit);
    }
    if (turn)
        for (Vec3& n : file.mesh.normals) n = {n.x, -n.z, n.y};
}

// The number of its group for every face.
FaceGroups groupsOf(MeshFile& file) {
    FaceGroups result;
    result.triangles.resize(file.mesh.triangles.size());
    result.quads.resize(file.mesh.quads.size());
    for (MeshGroup& group : file.groups) {
        const auto number = static_cast<std::uint32_t>(result.names.size());
        std::fill_n(result.triangles.begin() + static_cast<std::ptrdiff_t>(group.firstTriangle), group.triangleCount,
                    number);
        std::fill_n(result.quads.begin() + static_cast<std::ptrdiff_t>(group.firstQuad), group.quadCount, number);
        result.names.push_back(std::move(group.name));
    }
    return result;
}

std::optional<MeshData> fromFile(const schema::Text& file, double unit, bool zUp, FaceGroups* groups, Span span,
                                 Diagnostics& diagnostics) {
    std::optional<MeshData> mesh;
    readsFile(file.value, file.span.valid() ? file.span : span, diagnostics, [&] {
        MeshFile read = file.keys.empty() ? readMesh(file.value) : readGltf(file.value, gltfSelection(file));
        if (!read.leftOut.empty())
            diagnostics.warning("W0604", file.span.valid() ? file.span : span, "parts of this file are left out",
                                read.leftOut.front());
        toScene(read, unit, zUp);
        if (groups) *groups = groupsOf(read);
        mesh = std::move(read.mesh);
    });
    return mesh;
}

std::optional<MeshData> fromRows(const std::vector<Vec3d>& points, const schema::IndexRows& faces, Span span,
                                 Diagnostics& diagnostics) {
    MeshData mesh;
    mesh.positions.reserve(points.size());
    for (Vec3d p : points) mesh.positions.push_back(Vec3(p));
    const std::span<const std::uint32_t> all(faces.indices);
    std::size_t first = 0;
    for (std::size_t face = 0; face < faces.counts.size(); ++face) {
        const std::span<const std::uint32_t> corners = all.subspan(first, faces.counts[face]);
        first += corners.size();
        for (const std::uint32_t index : corners)
            if (index >= points.size()) {
                diagnostics.error(
                    "E0611", span,
                    fmt::format("face {} names vertex {}, but there are {} points", face, index, points.size()),
                    "counted from 0");
                return std::nullopt;
            }
        if (corners.size() < 3 || !addPolygon(mesh, corners)) {
            diagnostics.error("E0611", span,
                              fmt::format("face {} is no polygon that can be split into triangles", face),
                              fmt::format("{} corners", corners.size()));
            return std::nullopt;
        }
    }
    return mesh;
}

} // namespace

Vec3d farMiddle(const std::vector<Vec3d>& points) {
    if (points.empty()) return {};
    Vec3d lower = points[0], upper = points[0];
    for (const Vec3d p : points) lower = min(lower, p), upper = max(upper, p);
    const Vec3d middle = (lower + upper) * 0.5;
    constexpr double far = 64; // sizes of the mesh: six bits less for its details
    const bool isFar = maxComponent(abs(middle)) > far * maxComponent(upper - lower);
    return isFar && isFinite(middle) ? middle : Vec3d();
}

std::vector<Vec3d> relativeTo(Vec3d origin, std::vector<Vec3d> points) {
    for (Vec3d& p : points) p = p - origin;
    return points;
}

std::optional<MeshData> statedMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                   const schema::IndexRows& faces, Span span, Diagnostics& diagnostics, bool zUp,
                                   FaceGroups* groups) {
    auto mesh = file.value.empty() ? fromRows(points, faces, span, diagnostics)
                                   : fromFile(file, unit, zUp, groups, span, diagnostics);
    if (mesh && groups) { // what is written in place has none
        groups->triangles.resize(mesh->triangles.size());
        groups->quads.resize(mesh->quads.size());
    }
    return mesh;
}

std::optional<MeshData> loadMesh(const schema::Text& file, double unit, const std::vector<Vec3d>& points,
                                 const schema::IndexRows& faces, Span span, Diagnostics& diagnostics, bool zUp,
                                 FaceGroups* groups) {
    auto mesh = statedMesh(file, unit, points, faces, span, diagnostics, zUp, groups);
    if (!mesh) return std::nullopt;
    const MeshCleanup cleanup = cleanMesh(*mesh, groups);
    if (cleanup.error) {
        diagnostics.error("E0611", span, *cleanup.error, "damaged mesh");
        return std::nullopt;
    }
    if (mesh->triangles.empty() && mesh->quads.empty()) {
        diagnostics.error("E0604", span, "this mesh has no faces with an area", "nothing to see here");
        return std::nullopt;
    }
    if (cleanup.removed() > 0)
        diagnostics.warning("W0603", span, fmt::format("{} faces without area are left out", cleanup.removed()));
    return mesh;
}

// What is written in place for the points of meshes and cages.
bool addAttributes(const std::vector<schema::NamedNumbers>& stated, bool ofFile, std::size_t points,
                   std::vector<MeshAttribute>& to, Diagnostics& diagnostics) {
    for (const schema::NamedNumbers& one : stated) {
        const auto fault = [&](std::string message, std::string label) -> Diagnostic& {
            return diagnostics.error("E0737", one.span, std::move(message), std::move(label));
        };
        if (ofFile) {
            fault("`attribute` belongs to `points`", "here the points are those of a file").help =
                "a PLY file has attributes of its own: its vertex properties";
            return false;
        }
        if (std::ranges::find(to, one.name, &MeshAttribute::name) != to.end()) {
            fault(fmt::format("the attribute `{}` is there twice", one.name), "for the second time");
            return false;
        }
        const std::size_t count = one.values.size();
        if (count != points && count != 3 * points) {
            fault(fmt::format("the attribute `{}` has {} numbers for {} points", one.name, count, points),
                  fmt::format("one for each are {}, three are {}", points, 3 * points));
            return false;
        }
        MeshAttribute& made = to.emplace_back(MeshAttribute{one.name, count == points ? 1 : 3, {}});
        for (const double x : one.values) made.values.push_back(static_cast<float>(x));
        if (std::ranges::all_of(made.values, [](float x) { return std::isfinite(x); })) continue;
        fault(fmt::format("the attribute `{}` has a number that is too large", one.name), "beyond 3e38");
        return false;
    }
    return true;
}

bool addPointData(const MeshParams& params, bool ofFile, MeshData& mesh, Span span, Diagnostics& diagnostics) {
    const std::vector<double>& uvs = params.uvs;
    if (!uvs.empty() && ofFile) {
        diagnostics.error("E0611", span, "`uvs` belong to `points`: a file has its own", "damaged mesh");
        return false;
    }
    if (!uvs.empty() && uvs.size() != 2 * mesh.positions.size()) {
        diagnostics.error("E0611", span,
                          fmt::format("`uvs` are two numbers for each point, but there are {} for {} points",
                                      uvs.size(), mesh.positions.size()),
                          "damaged mesh");
        return false;
    }
    for (std::size_t i = 0; i < uvs.size(); i += 2)
        mesh.uvs.push_back({static_cast<float>(uvs[i]), static_cast<float>(uvs[i + 1])});
    return addAttributes(params.attributes, ofFile, mesh.positions.size(), mesh.attributes, diagnostics);
}

GltfSelection gltfSelection(const schema::Text& file) {
    GltfSelection selection;
    for (const auto& [key, value] : file.keys) {
        if (key == "node") selection.node = value;
        if (key == "mesh") selection.mesh = value;
        if (key == "animation") selection.animation = value;
        if (key == "time") std::from_chars(value.data(), value.data() + value.size(), selection.time.emplace());
    }
    return selection;
}

schema::TypeInfo meshType() {
    using namespace schema;
    using P = MeshParams;
    std::vector<FieldInfo> fields = {
        withGltfKeys(field<P, Text>(FieldType::file, "file", &P::file)
                         .argument(0)
                         .group("source")
                         .synonyms({"filename", "path"})
                         .doc("OBJ, PLY or glTF file, binary or text; quads are kept. glTF is in metres, with y up.")
                         .example("file \"bunny.ply\"")),
        field<P, std::vector<Vec3d>>(FieldType::points, "points", &P::points)
            .unit({Dimension::length})
            .group("source")
            .synonyms({"vertices", "P", "positions"})
            .doc("Vertex positions, one row of three numbers each, or one long list.")
            .example("points { - 0 0 0; - 1 0 0; - 0 1 0 }"),
        field<P, IndexRows>(FieldType::indexRows, "faces", &P::faces)
            .synonyms({"indices", "triangles", "polygons"})
            .doc("Rows of vertex numbers from 0, counter-clockwise seen from outside; polygons of any size.")
            .example("faces { - 0 1 2 }"),
        field<P, std::vector<double>>(FieldType::numbers, "uvs", &P::uvs)
            .synonyms({"st", "texture-coordinates", "vt", "uv"})
            .doc("Texture coordinates, two numbers for each of `points`.")
            .example("uvs { - 0 0; - 1 0; - 0 1 }"),
        attributeField<P>(),
        field<P, bool>(FieldType::toggle, "materials", &P::materials)
            .byDefault("off")
            .synonyms({"use-materials", "import-materials", "with-materials"})
            .doc("Take the materials of the file, glTF or OBJ, with their textures and their emission.")
            .example("materials on"),
    };
    fields.push_back(keysField<P>(meshKeyFields()));
    addGroupedShapeFields<P>(fields);
    return {Kind::shape,
            "mesh",
            "Polygon mesh from a file or written in place.",
            "shape mesh \"teapot.obj\" { material diffuse }",
            false,
            std::move(fields)};
}

void loadMeshShape(const MeshParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    if (!params.keys.empty()) return deformMesh(params, builder, shape);
    const ShapeContext context = builder.contextOf(*shape.definition);
    if (params.materials) {
        context.diagnostics.error("E0616", context.span, "the materials of the file have not been read",
                                  "`materials on`");
        return;
    }
    struct Loaded {
        MeshData mesh;
        FaceGroups groups;
    };
    const bool grouped = !params.groupMaterials.empty();
    const Vec3d origin = farMiddle(params.points);
    const auto loaded = builder.data<Loaded>(shape, [&]() -> std::shared_ptr<const Loaded> {
        FaceGroups groups;
        auto mesh = loadMesh(params.file, context.unit, relativeTo(origin, params.points), params.faces, context.span,
                             context.diagnostics, context.zUp, grouped ? &groups : nullptr);
        if (!mesh || !addPointData(params, !params.file.value.empty(), *mesh, context.span, context.diagnostics))
            return nullptr;
        return std::make_shared<const Loaded>(Loaded{std::move(*mesh), std::move(groups)});
    });
    if (!loaded) return;
    if (!params.file.value.empty()) builder.scene.noteFile(params.file.value);
    shape.meshOrigin = origin;
    shape.mesh = {loaded, &loaded->mesh};
    shape.sound = true;
    if (grouped) builder.chooseFaceMaterials(shape, loaded->groups);
    shape.place = [mesh = shape.mesh, origin, context](const Transform& place) {
        return placeMesh(*mesh, Transform::translate(origin).then(place), context.span, context.diagnostics);
    };
}

} // namespace abbe

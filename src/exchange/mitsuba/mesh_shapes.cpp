#include "exchange/mitsuba/shapes.h"
#include "exchange/mitsuba/xml_values.h"
#include "exchange/shared/ply_writer.h"
#include "io/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// The corner's angle weighs a face's normal [Thurmer1998], as in Mitsuba.
template <std::size_t N>
void addCornerNormals(std::vector<Vec3d>& sums, const MeshData& mesh, const std::array<std::uint32_t, N>& face) {
    for (std::size_t i = 0; i < N; ++i) {
        const Vec3d at(mesh.positions[face[i]]);
        const Vec3d a = Vec3d(mesh.positions[face[(i + 1) % N]]) - at,
                    b = Vec3d(mesh.positions[face[(i + N - 1) % N]]) - at;
        const Vec3d n = cross(a, b);
        const double size = length(n);
        if (size > 0) sums[face[i]] += n * (std::atan2(size, dot(a, b)) / size);
    }
}

void smoothNormals(MeshData& mesh) {
    std::vector<Vec3d> sums(mesh.positions.size());
    for (const auto& face : mesh.triangles) addCornerNormals(sums, mesh, face);
    for (const auto& face : mesh.quads) addCornerNormals(sums, mesh, face);
    mesh.normals.clear();
    for (const Vec3d& sum : sums) mesh.normals.push_back(lengthSquared(sum) > 0 ? Vec3(normalize(sum)) : Vec3(0, 0, 0));
}

void turnFaces(MeshData& mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    for (auto& q : mesh.quads) std::swap(q[1], q[3]);
    for (Vec3& n : mesh.normals) n = -n;
}

// Properties r, g and b of a PLY file are a colour to Mitsuba, three numbers to us.
MeshData withColors(MeshData mesh) {
    std::array<const MeshAttribute*, 3> parts{};
    constexpr std::array<std::string_view, 3> kNames = {"r", "g", "b"};
    for (const MeshAttribute& a : mesh.attributes)
        for (std::size_t i = 0; i < 3; ++i)
            if (a.name == kNames[i] && a.channels == 1) parts[i] = &a;
    if (!parts[0] || !parts[1] || !parts[2]) return mesh;
    MeshAttribute color{"color", 3, {}};
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        for (const MeshAttribute* part : parts) color.values.push_back(part->values[i]);
    std::erase_if(mesh.attributes, [&](const MeshAttribute& a) {
        return a.name == "r" || a.name == "g" || a.name == "b" || a.name == "color";
    });
    mesh.attributes.push_back(std::move(color));
    return mesh;
}

std::optional<MeshData> loadMesh(const XmlObject& shape, const std::filesystem::path& path, MitsubaContext& ctx) {
    try {
        if (shape.plugin != "serialized") return withColors(readMesh(path.string()).mesh);
        const double index = mitsubaNumber(shape, "shape_index", 0, ctx.import);
        return readSerializedMesh(path.string(), static_cast<std::size_t>(std::clamp(index, 0.0, 1e9)));
    } catch (const IoError& fault) {
        ctx.import.diagnostics.error("E0402", shape.span, fault.what());
        return std::nullopt;
    }
}

void notePoints(const MeshData& mesh, const XmlObject& shape, MitsubaContext& ctx) {
    Bounds3d box;
    for (const Vec3& p : mesh.positions) box.add(Vec3d(p));
    ctx.noteBounds(box, mitsubaTransform(shape));
}

// Lines of x y z radius; an empty line ends a strand.
struct Strands {
    MeshData points;
    std::vector<std::size_t> counts;
    bool sound = true;
};

Strands readStrands(const std::string& text) {
    Strands out;
    out.points.attributes = {{"radius", 1, {}}};
    std::size_t inStrand = 0;
    const auto end = [&] {
        if (inStrand > 0) out.counts.push_back(std::exchange(inStrand, 0));
    };
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t stop = std::min(text.find('\n', at), text.size());
        const auto numbers = xmlNumbers(std::string_view(text).substr(at, stop - at));
        at = stop + 1;
        if (numbers && numbers->empty()) {
            end();
        } else if (!numbers || numbers->size() != 4) {
            out.sound = false;
            return out;
        } else {
            out.points.positions.push_back(Vec3(Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2])));
            out.points.attributes[0].values.push_back(static_cast<float>((*numbers)[3]));
            ++inStrand;
        }
    }
    end();
    return out;
}

} // namespace

ShapeForm writeMesh(SceneNode& node, MeshData mesh, const XmlObject& shape, MitsubaContext& ctx) {
    notePoints(mesh, shape, ctx);
    const std::string_view stem = shape.id.empty() ? shape.plugin : shape.id;
    node.word("mesh").text(ctx.import.files.write(stem, "ply", binaryPly(mesh)));
    writeTransform(node, mitsubaTransform(shape));
    return {true, false};
}

ShapeForm writeMeshFile(SceneNode& node, const XmlObject& shape, const MaterialTraits& traits, MitsubaContext& ctx) {
    const XmlParam* const file = shape.find("filename");
    if (!file) {
        ctx.import.diagnostics.error("E0802", shape.span, fmt::format("`{}` needs a `filename`", shape.plugin));
        return {};
    }
    const auto path = findXmlFile(ctx.scene, *file, ctx.import);
    if (!path) return {};
    auto mesh = loadMesh(shape, *path, ctx);
    if (!mesh) return {};
    const bool obj = shape.plugin == "obj";
    const bool faces = mitsubaFlag(shape, "face_normals", false, ctx.import);
    const bool flip = mitsubaFlag(shape, "flip_normals", false, ctx.import);
    const bool turned = mitsubaFlag(shape, "flip_tex_coords", obj, ctx.import);
    if (mesh->triangles.empty() && mesh->quads.empty()) {
        ctx.import.leftOut(nullptr, shape.span, "a mesh", "it has no faces");
        return {};
    }
    // The file does as it is where it says all that counts: normals, and coordinates the right way up.
    const bool colored = std::ranges::find(mesh->attributes, "color", &MeshAttribute::name) != mesh->attributes.end();
    const bool asItIs = shape.plugin != "serialized" && !flip && !(colored && traits.textured) &&
                        (faces ? mesh->normals.empty() : !mesh->normals.empty()) &&
                        (!traits.textured || mesh->uvs.empty() || (turned && !traits.toUv));
    if (asItIs) {
        notePoints(*mesh, shape, ctx);
        node.word("mesh").text(ctx.import.files.refer(*path));
        writeTransform(node, mitsubaTransform(shape));
        return {true, false, !turned};
    }
    if (faces)
        mesh->normals.clear();
    else if (mesh->normals.empty())
        smoothNormals(*mesh);
    if (flip) turnFaces(*mesh);
    if (turned)
        for (Vec2& uv : mesh->uvs) uv.y = 1 - uv.y;
    turnCoordinates(*mesh, traits);
    ShapeForm form = writeMesh(node, std::move(*mesh), shape, ctx);
    form.turned = !turned;
    return form;
}

ShapeForm writeCurves(SceneNode& node, const XmlObject& shape, MitsubaContext& ctx) {
    const XmlParam* const file = shape.find("filename");
    const auto path = file ? findXmlFile(ctx.scene, *file, ctx.import) : std::nullopt;
    if (!path) {
        if (!file) ctx.import.diagnostics.error("E0802", shape.span, "curves need a `filename`");
        return {};
    }
    RegularFile bytes(path->string());
    const Strands strands = readStrands(bytes.readAll());
    const bool spline = shape.plugin == "bsplinecurve";
    const std::size_t least = spline ? 4 : 2;
    const bool longEnough = std::ranges::all_of(strands.counts, [&](std::size_t n) { return n >= least; });
    if (!strands.sound || strands.counts.empty() || !longEnough) {
        ctx.import.diagnostics.error(
            "E0402", shape.span,
            fmt::format("`{}` has no strands of at least {} lines with four numbers", path->string(), least));
        return {};
    }
    notePoints(strands.points, shape, ctx);
    node.word("curves").text(
        ctx.import.files.write(shape.id.empty() ? shape.plugin : shape.id, "ply", binaryPly(strands.points)));
    node.child("basis").word(spline ? "bspline" : "linear");
    SceneNode& counts = node.child("counts");
    for (const std::size_t n : strands.counts) counts.number(static_cast<double>(n));
    writeTransform(node, mitsubaTransform(shape));
    return {true, true};
}

} // namespace abbe::exchange

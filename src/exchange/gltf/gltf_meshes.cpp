// The primitives of a mesh as shapes with PLY files.
#include "exchange/gltf/gltf_bending.h"
#include "exchange/gltf/gltf_nodes.h"
#include "exchange/shared/ply_writer.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Faces without an area, as poles of spheres and joints of strips have them: what a render would leave out (W0603).
void dropFlat(MeshData& mesh) {
    Bounds3d box;
    for (const Vec3& p : mesh.positions) box.add(Vec3d(p));
    const double least = 2e-12 * lengthSquared(box.diagonal());
    std::erase_if(mesh.triangles, [&](const auto& t) {
        const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
        const double twice = length(cross(b - a, c - a)),
                     longest = std::max({lengthSquared(b - a), lengthSquared(c - b), lengthSquared(a - c)});
        return !(twice > 1e-6 * longest) && !(twice > least);
    });
}

} // namespace

GltfNodes::Parts GltfNodes::parts(const GltfNodePose& pose, const std::string& wish, const Transform& toBox,
                                  bool dark) {
    const int index = ctx_.model().nodes[static_cast<std::size_t>(pose.node)].mesh;
    const tinygltf::Mesh& mesh = ctx_.model().meshes[static_cast<std::size_t>(index)];
    Parts made;
    const std::vector<double> times = gltfBendingTimes(ctx_, pose.node);
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
        GltfPrimitive primitive = gltfPrimitive(ctx_.document, ctx_.pose, pose.node, static_cast<int>(i));
        if (!primitive.leftOut.empty()) {
            ctx_.import.leftOut(nullptr, ctx_.places.of("meshes", index),
                                fmt::format("meshes[{}].primitives[{}]", index, i),
                                fmt::format("it has {}, which have no width in the file", primitive.leftOut));
            continue;
        }
        if (times.empty()) dropFlat(primitive.mesh); // else they have an area at another time
        if (primitive.mesh.triangles.empty()) continue;
        SceneNode shape("shape");
        const std::string name = ctx_.shapeNames.take(wish, fmt::format("mesh-{}", index));
        shape.name(name).word("mesh");
        writeSurface(shape, mesh.primitives[i], primitive, dark || !times.empty());
        const Transform toScene = primitive.skinned ? Transform{} : toBox;
        for (const Vec3& p : primitive.mesh.positions) made.box.add(toScene.point(Vec3d(p)));
        if (times.empty())
            shape.text(ctx_.import.files.write(name, "ply", binaryPly(primitive.mesh)));
        else
            writeBending(shape, name, GltfBending(ctx_, pose.node, static_cast<int>(i), primitive.mesh, times),
                         [&](const Vec3& p) { made.box.add(toScene.point(Vec3d(p))); });
        writeVariants(shape, mesh.primitives[i]);
        made.shapes.push_back(std::move(shape));
    }
    return made;
}

// The material, and in the mesh what it needs: one set of texture coordinates, and the values that it multiplies.
void GltfNodes::writeSurface(SceneNode& shape, const tinygltf::Primitive& primitive, GltfPrimitive& part, bool dark) {
    MeshData& mesh = part.mesh;
    const auto has = [&](std::string_view name) {
        return std::ranges::any_of(mesh.attributes, [&](const MeshAttribute& a) { return a.name == name; });
    };
    const int count = static_cast<int>(ctx_.model().materials.size());
    if (primitive.material >= count)
        ctx_.import.diagnostics.error(
            "E0802", ctx_.places.of("materials", -1),
            fmt::format("a primitive has material {}, but the file has {}", primitive.material, count));
    const GltfMaterial& material = materials_.of(primitive.material, {has("color"), has("alpha"), dark});
    shape.child("material").name(material.name);
    if (material.uvSet == 1) mesh.uvs = std::move(part.uvs1);
    if (material.uvSet < 0) mesh.uvs.clear();
    if (material.uvSet < 0 || !mesh.uvs.empty()) return;
    ctx_.import.approximated(&shape, ctx_.places.of("materials", primitive.material),
                             fmt::format("the textures of material `{}`", material.name),
                             fmt::format("a mesh has no TEXCOORD_{}: they show one place there", material.uvSet));
    mesh.uvs.resize(mesh.positions.size());
}

// One file, or a key for each of several. All of their points are to be in the picture.
void GltfNodes::writeBending(SceneNode& shape, const std::string& name, GltfBending bending,
                             const std::function<void(const Vec3&)>& show) {
    std::vector<std::pair<double, std::string>> keys;
    bending.write([&](double time, const MeshData& mesh) {
        std::ranges::for_each(mesh.positions, show);
        keys.emplace_back(time, ctx_.import.files.write(name, "ply", binaryPly(mesh)));
    });
    if (keys.size() == 1) return void(shape.text(keys[0].second));
    for (const auto& [time, file] : keys) shape.child("at").number(time).word("s").child("file").text(file);
}

// Names the other materials that the file offers for the primitive.
void GltfNodes::writeVariants(SceneNode& shape, const tinygltf::Primitive& primitive) {
    const auto found = primitive.extensions.find("KHR_materials_variants");
    if (found == primitive.extensions.end() || !found->second.Has("mappings")) return;
    const tinygltf::Value& mappings = found->second.Get("mappings");
    const auto& all = ctx_.model().extensions;
    const auto listed = all.find("KHR_materials_variants");
    for (std::size_t i = 0; i < mappings.ArrayLen(); ++i) {
        const tinygltf::Value& mapping = mappings.Get(static_cast<int>(i));
        if (!mapping.IsObject() || !mapping.Get("material").IsNumber() || !mapping.Get("variants").IsArray()) continue;
        const int material = gltfIndex(mapping.Get("material"));
        if (static_cast<std::size_t>(material) >= ctx_.model().materials.size()) continue;
        std::string names;
        for (std::size_t v = 0; v < mapping.Get("variants").ArrayLen(); ++v) {
            const tinygltf::Value& number = mapping.Get("variants").Get(static_cast<int>(v));
            std::string name;
            if (number.IsNumber() && listed != all.end() && listed->second.Has("variants") &&
                listed->second.Get("variants").IsArray()) {
                const tinygltf::Value& variant = listed->second.Get("variants").Get(gltfIndex(number));
                if (variant.IsObject() && variant.Get("name").IsString()) name = variant.Get("name").Get<std::string>();
            }
            names += fmt::format("{}`{}`", names.empty() ? "" : ", ", name);
        }
        shape.remark(fmt::format("Variant {}: {} of the file", names,
                                 gltfName("material", "materials", material,
                                          ctx_.model().materials[static_cast<std::size_t>(material)].name)));
    }
}

} // namespace abbe::exchange

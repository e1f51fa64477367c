// One primitive of a glTF file as it is at a time: its attributes, morphed and bent by its skin; and its copies.
#include "base/memory_limit.h"
#include "io/gltf_scene.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

struct VertexNumbers {
    int components = 0;
    std::vector<float> values; // empty: the primitive has none
};

class PrimitiveReader {
  public:
    PrimitiveReader(const GltfDocument& document, const GltfPose& pose, int node, int primitive);
    GltfPrimitive read();

  private:
    const char* leftOut() const;
    void checkWork();
    VertexNumbers attribute(const std::string& name, int components) const;
    VertexNumbers morphed(const std::string& name, int components) const;
    std::vector<std::uint32_t> corners() const;
    void addTriangles(MeshData&) const;
    void addVertices(GltfPrimitive&) const;
    std::vector<Transform> jointMaps(int skin) const;
    std::vector<Transform> vertexMaps(int skin) const;
    void bend(GltfPrimitive&, int skin) const;

    const GltfDocument& document_;
    const GltfPose& pose_;
    const GltfNodePose* here_;
    const tinygltf::Primitive* primitive_;
    std::string path_;
    std::optional<GltfUnpacked> unpacked_;
    std::size_t count_ = 0; // vertices
};

PrimitiveReader::PrimitiveReader(const GltfDocument& document, const GltfPose& pose, int node, int primitive)
    : document_(document), pose_(pose), here_(pose.find(node)) {
    const tinygltf::Mesh* const mesh = here_ ? document.meshOf(node) : nullptr;
    if (!mesh || static_cast<std::size_t>(primitive) >= mesh->primitives.size())
        document.fail(fmt::format("nodes[{}] has no primitive {}", node, primitive));
    primitive_ = &mesh->primitives[static_cast<std::size_t>(primitive)];
    path_ = fmt::format("meshes[{}].primitives[{}]", document.model().nodes[static_cast<std::size_t>(node)].mesh,
                        primitive);
}

const char* PrimitiveReader::leftOut() const {
    switch (primitive_->mode) {
    case TINYGLTF_MODE_POINTS:
        return "points";
    case TINYGLTF_MODE_LINE:
    case TINYGLTF_MODE_LINE_LOOP:
    case TINYGLTF_MODE_LINE_STRIP:
        return "lines";
    case TINYGLTF_MODE_TRIANGLES:
    case TINYGLTF_MODE_TRIANGLE_STRIP:
    case TINYGLTF_MODE_TRIANGLE_FAN:
        return "";
    default:
        document_.fail(fmt::format("{}.mode is {}", path_, primitive_->mode));
    }
}

// Morph targets may share their numbers: they are counted each.
void PrimitiveReader::checkWork() {
    double numbers = 0;
    const auto add = [&](int accessor, const char* who) {
        numbers += static_cast<double>(document_.count(accessor, path_ + who));
    };
    for (const auto& [name, accessor] : primitive_->attributes) add(accessor, ".attributes");
    for (std::size_t i = 0; i < std::min(primitive_->targets.size(), here_->weights.size()); ++i)
        for (const auto& [name, accessor] : primitive_->targets[i])
            if (here_->weights[i] != 0) add(accessor, ".targets");
    if (primitive_->indices >= 0) add(primitive_->indices, ".indices");
    document_.bound(numbers, path_);
    requireMemory(numbers * 64);
}

GltfPrimitive PrimitiveReader::read() {
    GltfPrimitive result;
    result.leftOut = leftOut();
    const auto position = primitive_->attributes.find("POSITION");
    if (!result.leftOut.empty() || position == primitive_->attributes.end()) return result; // allowed: nothing to see
    checkWork();
    count_ = document_.count(position->second, path_ + ".attributes.POSITION");
    if (primitive_->extensions.contains("KHR_draco_mesh_compression")) {
        unpacked_ = unpackDraco(document_, *primitive_, path_);
        if (unpacked_->vertices != count_)
            document_.fail(fmt::format("{}: the compressed stream has {} vertices, its accessor {}", path_,
                                       unpacked_->vertices, count_));
    }
    if (count_ > 0xfffffffeu) document_.fail(path_ + ": more vertices than 32 bits count");
    addVertices(result);
    addTriangles(result.mesh);
    const int skin = document_.model().nodes[static_cast<std::size_t>(here_->node)].skin;
    if (skin >= 0 && primitive_->attributes.contains("JOINTS_0")) bend(result, skin);
    return result;
}

VertexNumbers PrimitiveReader::attribute(const std::string& name, int components) const {
    const auto found = primitive_->attributes.find(name);
    if (found == primitive_->attributes.end()) return {};
    const std::string who = fmt::format("{}.attributes.{}", path_, name);
    if (unpacked_)
        for (const auto& a : unpacked_->attributes) {
            if (a.name != name) continue;
            if (components != 0 && a.components != components)
                document_.fail(fmt::format("{} has {} components instead of {}", who, a.components, components));
            return {a.components, a.values};
        }
    const std::size_t n = document_.count(found->second, who);
    if (n != count_) document_.fail(fmt::format("{}: {} values for {} positions", who, n, count_));
    if (components == 0) components = document_.components(found->second, who);
    return {components, document_.floats(found->second, components, who)};
}

// With what the morph targets add at their weights. Components 0: as many as there are.
VertexNumbers PrimitiveReader::morphed(const std::string& name, int components) const {
    VertexNumbers result = attribute(name, components);
    if (result.values.empty()) return result;
    const int added = name == "TANGENT" ? 3 : result.components; // the sign of a tangent stays
    const auto width = static_cast<std::size_t>(result.components), part = static_cast<std::size_t>(added);
    for (std::size_t t = 0; t < std::min(primitive_->targets.size(), here_->weights.size()); ++t) {
        const double weight = here_->weights[t];
        const auto found = primitive_->targets[t].find(name);
        if (weight == 0 || found == primitive_->targets[t].end()) continue;
        const std::string who = fmt::format("{}.targets[{}].{}", path_, t, name);
        const std::size_t n = document_.count(found->second, who);
        if (n != count_) document_.fail(fmt::format("{}: {} values for {} positions", who, n, count_));
        const std::vector<float> more = document_.floats(found->second, added, who);
        for (std::size_t i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < part; ++c) {
                float& value = result.values[i * width + c];
                value =
                    static_cast<float>(static_cast<double>(value) + weight * static_cast<double>(more[i * part + c]));
                if (!std::isfinite(value)) document_.fail(fmt::format("{}: vertex {} goes too far", who, i));
            }
    }
    return result;
}

Vec3 unitOrNone(Vec3d v) {
    const double l = length(v);
    return l > 0 && std::isfinite(l) ? Vec3(v * (1 / l)) : Vec3();
}

void PrimitiveReader::addVertices(GltfPrimitive& to) const {
    MeshData& mesh = to.mesh;
    const auto vectors = [&](const VertexNumbers& n) {
        std::vector<Vec3> result;
        for (std::size_t i = 0; i + 2 < n.values.size(); i += 3)
            result.emplace_back(n.values[i], n.values[i + 1], n.values[i + 2]);
        return result;
    };
    const auto coordinates = [&](const VertexNumbers& n) {
        std::vector<Vec2> result;
        for (std::size_t i = 0; i + 1 < n.values.size(); i += 2) result.push_back({n.values[i], 1 - n.values[i + 1]});
        return result;
    };
    mesh.positions = vectors(morphed("POSITION", 3));
    mesh.normals = vectors(morphed("NORMAL", 3));
    for (Vec3& n : mesh.normals) n = unitOrNone(Vec3d(n));
    mesh.uvs = coordinates(morphed("TEXCOORD_0", 2));
    to.uvs1 = coordinates(morphed("TEXCOORD_1", 2));
    if (!mesh.normals.empty()) // without them tangents mean nothing, as the format says
        for (const VertexNumbers tangents = morphed("TANGENT", 4); to.tangents.size() < tangents.values.size() / 4;) {
            const float* const t = &tangents.values[4 * to.tangents.size()];
            const Vec3 unit = unitOrNone(Vec3d(Vec3(t[0], t[1], t[2])));
            to.tangents.push_back({unit.x, unit.y, unit.z, t[3] < 0 ? -1.f : 1.f});
        }
    const VertexNumbers color = morphed("COLOR_0", 0);
    if (color.values.empty()) return;
    if (color.components < 3 || color.components > 4)
        document_.fail(fmt::format("{}.attributes.COLOR_0 has {} components", path_, color.components));
    MeshAttribute rgb{"color", 3, {}}, alpha{"alpha", 1, {}};
    const auto width = static_cast<std::size_t>(color.components);
    for (std::size_t i = 0; i < color.values.size(); ++i)
        (i % width < 3 ? rgb : alpha).values.push_back(std::clamp(color.values[i], 0.f, 1.f));
    mesh.attributes.push_back(std::move(rgb));
    if (width == 4) mesh.attributes.push_back(std::move(alpha));
}

std::vector<std::uint32_t> PrimitiveReader::corners() const {
    if (unpacked_) return unpacked_->corners;
    if (primitive_->indices >= 0) return document_.indices(primitive_->indices, count_, path_ + ".indices");
    std::vector<std::uint32_t> all(count_);
    for (std::size_t i = 0; i < count_; ++i) all[i] = static_cast<std::uint32_t>(i);
    return all;
}

void PrimitiveReader::addTriangles(MeshData& mesh) const {
    const std::vector<std::uint32_t> at = corners();
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        mesh.triangles.push_back({at[a], at[b], at[c]});
    };
    const std::size_t n = at.size();
    if (primitive_->mode == TINYGLTF_MODE_TRIANGLES || unpacked_) { // compressed strips are unpacked as triangles
        if (n % 3 != 0) document_.fail(fmt::format("{}: {} corners are no triangles", path_, n));
        for (std::size_t i = 0; i + 2 < n; i += 3) add(i, i + 1, i + 2);
    } else if (primitive_->mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        for (std::size_t i = 0; i + 2 < n; ++i) add(i, i + 1 + i % 2, i + 2 - i % 2);
    } else {
        for (std::size_t i = 1; i + 1 < n; ++i) add(i, i + 1, 0);
    }
}

// From the space of the mesh to that of the scene, for every joint.
std::vector<Transform> PrimitiveReader::jointMaps(int index) const {
    const auto& skins = document_.model().skins;
    if (static_cast<std::size_t>(index) >= skins.size())
        document_.fail(fmt::format("nodes[{}].skin is {}, but there are {}", here_->node, index, skins.size()));
    const tinygltf::Skin& skin = skins[static_cast<std::size_t>(index)];
    const std::string path = fmt::format("skins[{}]", index), who = path + ".inverseBindMatrices";
    std::vector<float> inverse;
    if (skin.inverseBindMatrices >= 0) {
        if (const std::size_t n = document_.count(skin.inverseBindMatrices, who); n < skin.joints.size())
            document_.fail(fmt::format("{}: {} matrices for {} joints", who, n, skin.joints.size()));
        inverse = document_.floats(skin.inverseBindMatrices, 16, who);
    }
    std::vector<Transform> maps;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        const GltfNodePose* const joint = pose_.find(skin.joints[j]);
        if (!joint) document_.fail(fmt::format("{}.joints[{}] is {}, no node of the scene", path, j, skin.joints[j]));
        Transform bind;
        const float* const m = inverse.empty() ? nullptr : &inverse[16 * j]; // by columns
        for (std::size_t r = 0; m && r < 3; ++r) {
            for (std::size_t c = 0; c < 3; ++c) bind.a[r][c] = static_cast<double>(m[4 * c + r]);
        }
        if (m) bind.t = Vec3d(Vec3(m[12], m[13], m[14]));
        maps.push_back(bind.then(joint->world));
    }
    return maps;
}

void addScaled(Transform& to, const Transform& map, double weight) {
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) to.a[r][c] += weight * map.a[r][c];
    to.t = to.t + map.t * weight;
}

// The mean of its joints' maps for every vertex. One without weights stays as it is.
std::vector<Transform> PrimitiveReader::vertexMaps(int skin) const {
    const std::vector<Transform> joints = jointMaps(skin);
    Transform nothing;
    for (auto& row : nothing.a)
        for (double& x : row) x = 0;
    std::vector<Transform> maps(count_, nothing);
    std::vector<double> sums(count_, 0);
    for (int set = 0; primitive_->attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
        const std::string name = fmt::format("JOINTS_{}", set);
        const VertexNumbers indices = attribute(name, 4), weights = attribute(fmt::format("WEIGHTS_{}", set), 4);
        if (weights.values.size() != indices.values.size())
            document_.fail(fmt::format("{}.attributes.{} has no weights beside it", path_, name));
        for (std::size_t i = 0; i < indices.values.size(); ++i) {
            const double weight = static_cast<double>(weights.values[i]);
            if (weight == 0) continue;
            const double joint = static_cast<double>(indices.values[i]);
            if (!(joint >= 0) || joint >= static_cast<double>(joints.size()) || !(weight > 0))
                document_.fail(fmt::format("{}.attributes.{}: vertex {} is at joint {} of {} with weight {}", path_,
                                           name, i / 4, joint, joints.size(), weight));
            addScaled(maps[i / 4], joints[static_cast<std::size_t>(joint)], weight);
            sums[i / 4] += weight;
        }
    }
    for (std::size_t i = 0; i < count_; ++i) {
        Transform mean = nothing;
        if (sums[i] > 0) addScaled(mean, maps[i], 1 / sums[i]); // they should be 1, but for rounding
        maps[i] = sums[i] > 0 ? mean : Transform();
    }
    return maps;
}

void PrimitiveReader::bend(GltfPrimitive& primitive, int skin) const {
    requireMemory(static_cast<double>(count_) * (sizeof(Transform) + 2 * 4 * sizeof(float)));
    const std::vector<Transform> maps = vertexMaps(skin);
    MeshData& mesh = primitive.mesh;
    primitive.skinned = true;
    for (std::size_t i = 0; i < count_; ++i) {
        const Vec3 p(maps[i].point(Vec3d(mesh.positions[i])));
        if (!isFinite(p)) document_.fail(fmt::format("{}: vertex {} is too far away", path_, i));
        mesh.positions[i] = p;
        if (!mesh.normals.empty()) mesh.normals[i] = unitOrNone(maps[i].normal(Vec3d(mesh.normals[i])));
        if (primitive.tangents.empty()) continue;
        auto& t = primitive.tangents[i];
        const Vec3 unit = unitOrNone(maps[i].vector(Vec3d(Vec3(t[0], t[1], t[2]))));
        t = {unit.x, unit.y, unit.z, t[3]};
    }
}

} // namespace

GltfPrimitive gltfPrimitive(const GltfDocument& document, const GltfPose& pose, int node, int primitive) {
    return PrimitiveReader(document, pose, node, primitive).read();
}

namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

// The accessor of an attribute of the copies, if they have it.
std::optional<int> instanceAccessor(const tinygltf::Node& node, const char* name) {
    const auto extension = node.extensions.find(kInstancing);
    if (extension == node.extensions.end() || !extension->second.Has("attributes")) return std::nullopt;
    const tinygltf::Value& attributes = extension->second.Get("attributes");
    if (!attributes.Has(name)) return std::nullopt;
    return attributes.Get(name).IsInt() ? attributes.Get(name).GetNumberAsInt() : -1; // no accessor: an error
}

std::string instancePath(int node, const char* name) {
    return fmt::format("nodes[{}].extensions.{}.attributes.{}", node, kInstancing, name);
}

} // namespace

std::size_t gltfInstanceCount(const GltfDocument& document, int index) {
    const tinygltf::Node& node = document.model().nodes[static_cast<std::size_t>(index)];
    std::optional<std::size_t> count;
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
        const std::optional<int> accessor = instanceAccessor(node, name);
        if (!accessor) continue;
        const std::string who = instancePath(index, name);
        const std::size_t n = document.count(*accessor, who);
        if (count && *count != n) document.fail(fmt::format("{}: {} values for {} copies", who, n, *count));
        count = n;
    }
    return count.value_or(1);
}

std::vector<Transform> gltfInstances(const GltfDocument& document, int index) {
    const tinygltf::Node& node = document.model().nodes[static_cast<std::size_t>(index)];
    const std::size_t count = gltfInstanceCount(document, index);
    requireMemory(static_cast<double>(count) * 2 * sizeof(Transform));
    const auto values = [&](const char* name, int components) {
        const std::optional<int> accessor = instanceAccessor(node, name);
        return accessor ? document.floats(*accessor, components, instancePath(index, name)) : std::vector<float>();
    };
    const std::vector<float> t = values("TRANSLATION", 3), r = values("ROTATION", 4), s = values("SCALE", 3);
    std::vector<Transform> maps;
    for (std::size_t i = 0; i < count; ++i) {
        const auto at = [i](const std::vector<float>& v, std::size_t n, std::size_t c, double otherwise) {
            return v.empty() ? otherwise : static_cast<double>(v[n * i + c]);
        };
        Decomposition d{{at(t, 3, 0, 0), at(t, 3, 1, 0), at(t, 3, 2, 0)},
                        {at(r, 4, 3, 1), {at(r, 4, 0, 0), at(r, 4, 1, 0), at(r, 4, 2, 0)}},
                        {}};
        const double l = std::hypot(d.rotation.w, length(d.rotation.v));
        if (!(l > 1e-6)) document.fail(fmt::format("{}: copy {} has no length", instancePath(index, "ROTATION"), i));
        d.rotation = {d.rotation.w / l, d.rotation.v / l};
        for (std::size_t c = 0; c < 3; ++c) d.stretch[c][c] = at(s, 3, c, 1);
        maps.push_back(d.compose());
    }
    return maps;
}

} // namespace abbe

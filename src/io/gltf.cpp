#include "io/gltf.h"

#include "base/memory_limit.h"
#include "io/file.h"
#include "io/gltf_document.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

class GltfMeshReader {
  public:
    explicit GltfMeshReader(const GltfDocument& document) : document_(document) {}

    MeshFile read(const GltfSelection&);

  private:
    void checkWork(const std::vector<PlacedGltfNode>&, const GltfSelection&) const;
    bool isChosen(const tinygltf::Mesh& mesh, const GltfSelection& selection) const {
        return selection.mesh.empty() || mesh.name == selection.mesh;
    }
    void readNode(const PlacedGltfNode&);
    void checkFeatures(const tinygltf::Node&, const tinygltf::Mesh&, int node) const;
    void readPrimitive(const tinygltf::Primitive&, const PlacedGltfNode&, const std::string& path);
    std::vector<std::uint32_t> corners(const tinygltf::Primitive&, std::size_t vertices, const std::string& path) const;
    void addVertices(const tinygltf::Primitive&, const Transform&, std::size_t count, const std::string& path);
    void addTriangles(const tinygltf::Primitive&, const std::vector<std::uint32_t>&, std::size_t firstVertex,
                      bool mirrored, const std::string& path);

    const GltfDocument& document_;
    MeshFile file_;
    bool anyNormals_ = false, anyUvs_ = false;
};

bool isTriangles(int mode) {
    return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
           mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

bool allZero(const std::vector<double>& weights) {
    for (const double w : weights)
        if (w != 0) return false;
    return true;
}

MeshFile GltfMeshReader::read(const GltfSelection& selection) {
    file_.coordinates = MeshCoordinates::metresYUp;
    const auto& model = document_.model();
    const auto nodes = document_.nodes(selection.node);
    checkWork(nodes, selection);
    bool found = selection.mesh.empty();
    for (const PlacedGltfNode& placed : nodes) {
        const int mesh = model.nodes[static_cast<std::size_t>(placed.node)].mesh;
        if (mesh < 0) continue;
        if (static_cast<std::size_t>(mesh) >= model.meshes.size())
            document_.fail(
                fmt::format("nodes[{}].mesh is {}, but there are {}", placed.node, mesh, model.meshes.size()));
        if (!isChosen(model.meshes[static_cast<std::size_t>(mesh)], selection)) continue;
        found = true;
        readNode(placed);
    }
    if (!found) document_.fail(fmt::format("no mesh of the scene is named `{}`", selection.mesh));
    if (!anyNormals_) file_.mesh.normals.clear();
    if (!anyUvs_) file_.mesh.uvs.clear();
    return std::move(file_);
}

// Nodes share meshes, meshes share accessors and accessors may have no bytes: what comes out of a file is not bounded
// by its size. A scene full of copies has some hundred vertices for a byte.
void GltfMeshReader::checkWork(const std::vector<PlacedGltfNode>& nodes, const GltfSelection& selection) const {
    constexpr double kMostPerByte = 1024;
    const auto& model = document_.model();
    const double most = kMostPerByte * static_cast<double>(document_.bytes());
    const auto countOf = [&](int accessor, const char* who) {
        const auto count = static_cast<double>(document_.count(accessor, who));
        if (count > most)
            document_.fail(fmt::format("accessors[{}] ({}): {:.0f} elements without data", accessor, who, count));
        return count;
    };
    double vertices = 0, corners = 0;
    for (const PlacedGltfNode& placed : nodes) {
        const auto mesh = static_cast<std::size_t>(model.nodes[static_cast<std::size_t>(placed.node)].mesh);
        if (mesh >= model.meshes.size() || !isChosen(model.meshes[mesh], selection)) continue;
        for (const tinygltf::Primitive& p : model.meshes[mesh].primitives) {
            const auto position = p.attributes.find("POSITION");
            if (position == p.attributes.end()) continue;
            vertices += countOf(position->second, "attributes.POSITION");
            if (p.indices >= 0) corners += countOf(p.indices, "indices");
        }
    }
    if (vertices + corners > most)
        document_.fail(fmt::format("its nodes have {:.4g} vertices and corners, more than {} for each of its {} bytes",
                                   vertices + corners, kMostPerByte, document_.bytes()));
    requireMemory(vertices * (2 * sizeof(Vec3) + sizeof(Vec2)) +
                  std::max(vertices, corners) * 2 * sizeof(std::uint32_t)); // numbers, and triangles made of them
}

// What would make the mesh look different from what is read.
void GltfMeshReader::checkFeatures(const tinygltf::Node& node, const tinygltf::Mesh& mesh, int index) const {
    if (node.skin >= 0) document_.fail(fmt::format("nodes[{}].skin: skinned meshes are not supported", index));
    if (node.extensions.contains("EXT_mesh_gpu_instancing"))
        document_.fail(fmt::format("nodes[{}]: EXT_mesh_gpu_instancing is not supported", index));
    if (!allZero(node.weights.empty() ? mesh.weights : node.weights))
        document_.fail(fmt::format("nodes[{}]: morph targets with weights are not supported", index));
}

void GltfMeshReader::readNode(const PlacedGltfNode& placed) {
    const auto& model = document_.model();
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(placed.node)];
    const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
    checkFeatures(node, mesh, placed.node);
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = mesh.primitives[i];
        const std::string path = fmt::format("meshes[{}].primitives[{}]", node.mesh, i);
        if (primitive.extensions.contains("KHR_draco_mesh_compression"))
            document_.fail(path + " is compressed by KHR_draco_mesh_compression, which is not supported");
        if (!isTriangles(primitive.mode)) {
            if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
                document_.fail(fmt::format("{}.mode is {}", path, primitive.mode));
            ++file_.ignoredFaces; // points or lines
            continue;
        }
        MeshGroup group{node.name.empty() ? mesh.name : node.name, {}, file_.mesh.triangles.size(), 0, 0, 0};
        if (primitive.material >= 0 && static_cast<std::size_t>(primitive.material) < model.materials.size())
            group.material = model.materials[static_cast<std::size_t>(primitive.material)].name;
        readPrimitive(primitive, placed, path);
        group.triangleCount = file_.mesh.triangles.size() - group.firstTriangle;
        if (group.triangleCount > 0) file_.groups.push_back(std::move(group));
    }
}

void GltfMeshReader::readPrimitive(const tinygltf::Primitive& primitive, const PlacedGltfNode& placed,
                                   const std::string& path) {
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return; // allowed, and nothing to see
    const std::string who = path + ".attributes.POSITION";
    const std::size_t count = document_.count(position->second, who), first = file_.mesh.positions.size();
    if (count > 0xfffffffeu - first) document_.fail(path + ": more vertices than 32 bits count");
    addVertices(primitive, placed.map, count, path);
    addTriangles(primitive, corners(primitive, count, path), first, placed.map.determinant() < 0, path);
}

void GltfMeshReader::addVertices(const tinygltf::Primitive& primitive, const Transform& map, std::size_t count,
                                 const std::string& path) {
    MeshData& mesh = file_.mesh;
    const auto attribute = [&](const char* name, int components) {
        const auto found = primitive.attributes.find(name);
        if (found == primitive.attributes.end()) return std::vector<float>();
        const std::string who = fmt::format("{}.attributes.{}", path, name);
        const std::size_t n = document_.count(found->second, who);
        if (n != count) document_.fail(fmt::format("{}: {} values for {} positions", who, n, count));
        return document_.floats(found->second, components, who);
    };
    const std::vector<float> positions = attribute("POSITION", 3), normals = attribute("NORMAL", 3);
    const std::vector<float> uvs = attribute("TEXCOORD_0", 2);
    anyNormals_ |= !normals.empty();
    anyUvs_ |= !uvs.empty();
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 p(map.point(Vec3d(Vec3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]))));
        if (!isFinite(p)) document_.fail(fmt::format("{}: vertex {} is too far away", path, i));
        mesh.positions.push_back(p);
        Vec3d n;
        if (!normals.empty()) n = map.normal(Vec3d(Vec3(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2])));
        const double l = length(n);
        mesh.normals.push_back(l > 0 && std::isfinite(l) ? Vec3(n * (1 / l)) : Vec3());
        mesh.uvs.push_back(uvs.empty() ? Vec2{} : Vec2{uvs[2 * i], 1 - uvs[2 * i + 1]});
    }
}

std::vector<std::uint32_t> GltfMeshReader::corners(const tinygltf::Primitive& primitive, std::size_t vertices,
                                                   const std::string& path) const {
    if (primitive.indices >= 0) return document_.indices(primitive.indices, vertices, path + ".indices");
    std::vector<std::uint32_t> all(vertices);
    for (std::size_t i = 0; i < vertices; ++i) all[i] = static_cast<std::uint32_t>(i);
    return all;
}

void GltfMeshReader::addTriangles(const tinygltf::Primitive& primitive, const std::vector<std::uint32_t>& corners,
                                  std::size_t firstVertex, bool mirrored, const std::string& path) {
    const auto first = static_cast<std::uint32_t>(firstVertex);
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        if (mirrored) std::swap(b, c); // keeps the outer side outside
        file_.mesh.triangles.push_back({first + corners[a], first + corners[b], first + corners[c]});
    };
    const std::size_t n = corners.size();
    if (primitive.mode == TINYGLTF_MODE_TRIANGLES) {
        if (n % 3 != 0) document_.fail(fmt::format("{}: {} corners are no triangles", path, n));
        for (std::size_t i = 0; i + 2 < n; i += 3) add(i, i + 1, i + 2);
    } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        for (std::size_t i = 0; i + 2 < n; ++i) add(i, i + 1 + i % 2, i + 2 - i % 2);
    } else {
        for (std::size_t i = 1; i + 1 < n; ++i) add(i, i + 1, 0);
    }
}

} // namespace

bool looksLikeGltf(std::string_view bytes) {
    if (isBinaryGltf(bytes)) return true;
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && bytes[first] == '{';
}

MeshFile parseGltf(std::string_view bytes, const std::string& name, const GltfSelection& selection) {
    const GltfDocument document(bytes, name);
    return GltfMeshReader(document).read(selection);
}

MeshFile readGltf(const std::string& path, const GltfSelection& selection) {
    return parseGltf(readFileBytes(path), path, selection);
}

namespace {

GltfCamera readCamera(const GltfDocument& document, const tinygltf::Camera& camera, int index) {
    const auto check = [&](bool good, const char* what) {
        if (!good) document.fail(fmt::format("cameras[{}].{}", index, what));
    };
    const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    GltfCamera result;
    result.name = camera.name;
    result.perspective = camera.type == "perspective";
    if (result.perspective) {
        const auto& p = camera.perspective;
        check(positive(p.yfov) && p.yfov < kPiD, "perspective.yfov is no angle between 0 and π");
        check(p.aspectRatio >= 0 && std::isfinite(p.aspectRatio), "perspective.aspectRatio is negative");
        result.verticalFov = p.yfov;
        result.aspect = p.aspectRatio;
        result.near = p.znear;
        result.far = p.zfar;
    } else {
        check(camera.type == "orthographic", "type is neither perspective nor orthographic");
        const auto& o = camera.orthographic;
        check(positive(std::abs(o.xmag)) && positive(std::abs(o.ymag)),
              "orthographic.xmag and ymag are not both above 0");
        result.halfWidth = std::abs(o.xmag);
        result.halfHeight = std::abs(o.ymag);
        result.near = o.znear;
        result.far = o.zfar;
    }
    return result;
}

} // namespace

std::vector<GltfCamera> parseGltfCameras(std::string_view bytes, const std::string& name) {
    const GltfDocument document(bytes, name);
    const auto& model = document.model();
    std::vector<GltfCamera> cameras;
    for (const PlacedGltfNode& placed : document.nodes({})) {
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(placed.node)];
        if (node.camera < 0) continue;
        if (static_cast<std::size_t>(node.camera) >= model.cameras.size())
            document.fail(fmt::format("nodes[{}].camera is {}, but there are {}", placed.node, node.camera,
                                      model.cameras.size()));
        cameras.push_back(readCamera(document, model.cameras[static_cast<std::size_t>(node.camera)], node.camera));
        if (!node.name.empty()) cameras.back().name = node.name;
        cameras.back().placement = placed.map;
    }
    return cameras;
}

std::vector<GltfCamera> readGltfCameras(const std::string& path) { return parseGltfCameras(readFileBytes(path), path); }

} // namespace abbe

#include "io/gltf.h"

#include "base/memory_limit.h"
#include "io/file.h"
#include "io/gltf_scene.h"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace abbe {

namespace {

constexpr std::size_t kMostLeftOut = 100; // that are named: nodes share meshes

class GltfMeshReader {
  public:
    GltfMeshReader(const GltfDocument& document, const GltfSelection& selection);

    MeshFile read();

  private:
    // A node with a mesh that was asked for.
    struct Chosen {
        const GltfNodePose* pose;
        const tinygltf::Mesh* mesh;
    };
    void choose(const std::string& mesh);
    double jointsOf(int skin) const;
    void checkWork() const;
    void readNode(const Chosen&);
    void add(const GltfPrimitive&, const Transform&, const std::string& path);
    void addAttributes(const MeshData&, std::size_t before);

    const GltfDocument& document_;
    GltfPose pose_;
    std::vector<Chosen> chosen_;
    MeshFile file_;
    bool anyNormals_ = false, anyUvs_ = false;
};

// Without a name the first animation, if there is a time.
int animationOf(const GltfDocument& document, const GltfSelection& selection) {
    if (!selection.animation.empty()) return GltfAnimation::named(document, selection.animation);
    if (!selection.time) return -1;
    if (document.model().animations.empty()) document.fail("it has no animation, and so no `time`");
    return 0;
}

GltfMeshReader::GltfMeshReader(const GltfDocument& document, const GltfSelection& selection) : document_(document) {
    file_.coordinates = MeshCoordinates::metresYUp;
    std::tie(pose_, file_.leftOut) = selectedPose(document, selection);
    choose(selection.mesh);
}

// Matrices that a primitive reads.
double GltfMeshReader::jointsOf(int skin) const {
    const auto& skins = document_.model().skins;
    if (static_cast<std::size_t>(skin) >= skins.size()) return 0;
    const tinygltf::Skin& of = skins[static_cast<std::size_t>(skin)];
    const int inverse = of.inverseBindMatrices;
    const std::size_t matrices = inverse < 0 ? 0 : document_.count(inverse, "inverseBindMatrices");
    return static_cast<double>(std::max(of.joints.size(), matrices));
}

void GltfMeshReader::choose(const std::string& name) {
    for (const GltfNodePose& pose : pose_.nodes()) {
        const tinygltf::Mesh* const mesh = document_.meshOf(pose.node);
        if (mesh && (name.empty() || mesh->name == name)) chosen_.push_back({&pose, mesh});
    }
    if (chosen_.empty() && !name.empty()) document_.fail(fmt::format("no mesh of the scene is named `{}`", name));
}

MeshFile GltfMeshReader::read() {
    checkWork();
    for (const Chosen& chosen : chosen_) readNode(chosen);
    if (!anyNormals_) file_.mesh.normals.clear();
    if (!anyUvs_) file_.mesh.uvs.clear();
    return std::move(file_);
}

// Nodes share meshes, meshes share accessors and accessors may have no bytes: what comes out of a file is not bounded
// by its size. A scene full of copies has some hundred vertices for a byte.
void GltfMeshReader::checkWork() const {
    double vertices = 0, corners = 0, joints = 0;
    const auto countOf = [&](int accessor, const char* who) {
        const auto count = static_cast<double>(document_.count(accessor, who));
        document_.bound(count, fmt::format("accessors[{}] ({})", accessor, who));
        return count;
    };
    for (const Chosen& chosen : chosen_) {
        const int skin = document_.model().nodes[static_cast<std::size_t>(chosen.pose->node)].skin;
        const auto copies = static_cast<double>(gltfInstanceCount(document_, chosen.pose->node));
        joints += copies;
        for (const tinygltf::Primitive& p : chosen.mesh->primitives) {
            joints += 1 + jointsOf(skin); // looking at one that is empty takes its time, too
            const auto position = p.attributes.find("POSITION");
            if (position == p.attributes.end()) continue;
            const double count = countOf(position->second, "attributes.POSITION");
            vertices += count * copies;
            joints += count * static_cast<double>(p.targets.size());
            if (p.indices >= 0) corners += countOf(p.indices, "indices") * copies;
        }
    }
    document_.bound(vertices + corners + joints, "the vertices, corners and joints of its nodes");
    requireMemory(vertices * (2 * sizeof(Vec3) + sizeof(Vec2)) +
                  std::max(vertices, corners) * 2 * sizeof(std::uint32_t)); // numbers, and triangles made of them
}

void GltfMeshReader::readNode(const Chosen& chosen) {
    const auto& model = document_.model();
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(chosen.pose->node)];
    const std::vector<Transform> copies = gltfInstances(document_, chosen.pose->node);
    for (std::size_t i = 0; i < chosen.mesh->primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = chosen.mesh->primitives[i];
        const std::string path = fmt::format("meshes[{}].primitives[{}]", node.mesh, i);
        const GltfPrimitive read = gltfPrimitive(document_, pose_, chosen.pose->node, static_cast<int>(i));
        if (!read.leftOut.empty()) {
            ++file_.ignoredFaces;
            if (file_.leftOut.size() < kMostLeftOut) file_.leftOut.push_back(fmt::format("{}: {}", path, read.leftOut));
            continue;
        }
        MeshGroup group{node.name.empty() ? chosen.mesh->name : node.name, {}, file_.mesh.triangles.size(), 0, 0, 0};
        if (primitive.material >= 0 && static_cast<std::size_t>(primitive.material) < model.materials.size())
            group.material = model.materials[static_cast<std::size_t>(primitive.material)].name;
        const Transform map = read.skinned ? Transform() : chosen.pose->world;
        for (const Transform& copy : copies) add(read, copy.then(map), path);
        group.triangleCount = file_.mesh.triangles.size() - group.firstTriangle;
        if (group.triangleCount > 0) file_.groups.push_back(std::move(group));
    }
}

void GltfMeshReader::add(const GltfPrimitive& primitive, const Transform& map, const std::string& path) {
    MeshData& mesh = file_.mesh;
    const MeshData& from = primitive.mesh;
    const std::size_t before = mesh.positions.size();
    if (from.positions.size() > 0xfffffffeu - before) document_.fail(path + ": more vertices than 32 bits count");
    anyNormals_ |= !from.normals.empty();
    anyUvs_ |= !from.uvs.empty();
    for (std::size_t i = 0; i < from.positions.size(); ++i) {
        const Vec3 p(map.point(Vec3d(from.positions[i])));
        if (!isFinite(p)) document_.fail(fmt::format("{}: vertex {} is too far away", path, i));
        mesh.positions.push_back(p);
        Vec3d n;
        if (!from.normals.empty()) n = map.normal(Vec3d(from.normals[i]));
        const double l = length(n);
        mesh.normals.push_back(l > 0 && std::isfinite(l) ? Vec3(n * (1 / l)) : Vec3());
    }
    mesh.uvs.insert(mesh.uvs.end(), from.uvs.begin(), from.uvs.end());
    mesh.uvs.resize(mesh.positions.size(), Vec2{});
    addAttributes(from, before);
    const bool mirrored = map.determinant() < 0;
    const auto first = static_cast<std::uint32_t>(before);
    for (auto [a, b, c] : from.triangles) {
        if (mirrored) std::swap(b, c); // keeps the outer side outside
        mesh.triangles.push_back({first + a, first + b, first + c});
    }
}

// A primitive without colours beside others that have them is white, as without any.
void GltfMeshReader::addAttributes(const MeshData& from, std::size_t before) {
    MeshData& mesh = file_.mesh;
    for (const MeshAttribute& a : from.attributes)
        if (std::ranges::find(mesh.attributes, a.name, &MeshAttribute::name) == mesh.attributes.end())
            mesh.attributes.push_back(
                {a.name, a.channels, std::vector<float>(before * static_cast<std::size_t>(a.channels), 1.f)});
    for (MeshAttribute& a : mesh.attributes) {
        const auto own = std::ranges::find(from.attributes, a.name, &MeshAttribute::name);
        if (own != from.attributes.end()) a.values.insert(a.values.end(), own->values.begin(), own->values.end());
        a.values.resize(mesh.positions.size() * static_cast<std::size_t>(a.channels), 1.f);
    }
}

} // namespace

bool looksLikeGltf(std::string_view bytes) {
    if (isBinaryGltf(bytes)) return true;
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && bytes[first] == '{';
}

std::pair<GltfPose, std::vector<std::string>> selectedPose(const GltfDocument& document,
                                                           const GltfSelection& selection) {
    const GltfAnimation animation(document, animationOf(document, selection));
    const auto span = animation.span();
    return {animation.pose(selection.time.value_or(span ? span->first : 0), selection.node), animation.leftOut()};
}

MeshFile parseGltf(std::string_view bytes, const std::string& name, const GltfSelection& selection) {
    const GltfDocument document(bytes, name);
    return GltfMeshReader(document, selection).read();
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
    const GltfPose pose = GltfAnimation(document, -1).pose(0);
    for (const GltfNodePose& placed : pose.nodes()) {
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(placed.node)];
        if (node.camera < 0) continue;
        if (static_cast<std::size_t>(node.camera) >= model.cameras.size())
            document.fail(fmt::format("nodes[{}].camera is {}, but there are {}", placed.node, node.camera,
                                      model.cameras.size()));
        cameras.push_back(readCamera(document, model.cameras[static_cast<std::size_t>(node.camera)], node.camera));
        if (!node.name.empty()) cameras.back().name = node.name;
        cameras.back().placement = placed.world;
    }
    return cameras;
}

std::vector<GltfCamera> readGltfCameras(const std::string& path) { return parseGltfCameras(readFileBytes(path), path); }

} // namespace abbe

#include "io/mesh_file.h"

#include "io/cage_file.h"
#include "io/file_bytes.h"
#include "io/gltf.h"

namespace abbe {

namespace {

bool isPly(std::string_view bytes) {
    return bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || bytes.starts_with("ply ");
}

} // namespace

MeshFile readMesh(const std::string& path) {
    const std::string bytes = readFileBytes(path);
    if (looksLikeGltf(bytes)) return parseGltf(bytes, path);
    return isPly(bytes) ? parsePly(bytes, path) : parseObj(bytes, path);
}

CageFile readCage(const std::string& path) {
    const std::string bytes = readFileBytes(path);
    if (looksLikeGltf(bytes))
        throw IoError("cannot read `" + path + "`: glTF files hold triangles, no cages; `shape mesh` takes them");
    return isPly(bytes) ? parsePlyCage(bytes, path) : parseObjCage(bytes, path);
}

MeshData extractGroup(const MeshFile& file, const MeshGroup& group) {
    constexpr std::uint32_t unused = 0xffffffffu;
    const MeshData& all = file.mesh;
    MeshData part;
    std::vector<std::uint32_t> map(all.positions.size(), unused);
    const auto vertex = [&](std::uint32_t v) {
        if (map[v] == unused) {
            map[v] = static_cast<std::uint32_t>(part.positions.size());
            part.positions.push_back(all.positions[v]);
            if (!all.normals.empty()) part.normals.push_back(all.normals[v]);
            if (!all.uvs.empty()) part.uvs.push_back(all.uvs[v]);
        }
        return map[v];
    };
    for (std::size_t i = 0; i < group.triangleCount; ++i) {
        const auto& t = all.triangles[group.firstTriangle + i];
        part.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
    }
    for (std::size_t i = 0; i < group.quadCount; ++i) {
        const auto& q = all.quads[group.firstQuad + i];
        part.quads.push_back({vertex(q[0]), vertex(q[1]), vertex(q[2]), vertex(q[3])});
    }
    return part;
}

} // namespace abbe

// What the writers of one glTF file share: the document and its one buffer.
#pragma once

#include "exchange/stated/export.h"
#include "math/mesh_data.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace abbe::exchange {

// The bytes of a .glb file, images inside: surfaces as triangles, materials of the metallic-roughness model with
// ratified extensions, cameras, and lights that are points or directions. In metres with y up. Throws IoError.
std::string exportGltf(Export&);

using GltfJson = nlohmann::ordered_json; // the same scene gives the same bytes

struct GltfWriter {
    explicit GltfWriter(Export& to) : out(to) {}

    Export& out;
    GltfJson document;
    std::string buffer;
    std::set<std::string> extensions;
    std::map<const StatedThing*, std::size_t> materials;
    std::map<std::string, std::size_t> images; // textures by file

    // Appends to a list of the document ("nodes"); its index there.
    std::size_t add(const char* list, GltfJson item);
    // A view of bytes at the end of the buffer.
    std::size_t addView(std::string_view bytes, int target = 0);
};

// The index of a material; nothing where a shape has none.
std::size_t gltfMaterial(const StatedThing&, GltfWriter&);
// A black surface that gives off light, in nits.
std::size_t gltfLamp(const StatedThing&, Vec3d nits, GltfWriter&);

// The index of a mesh of triangles, one primitive.
std::size_t gltfMesh(MeshData, std::string_view name, std::optional<std::size_t> material, GltfWriter&);

GltfJson gltfMatrix(const Transform&);

} // namespace abbe::exchange

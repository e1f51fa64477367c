// Scenes of glTF 2.0, as text or binary: one file of nodes, and the buffers and images that it names
// (docs/importing_gltf.md).
#pragma once

#include "exchange/shared/import.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

// Whether a file begins as one: `glTF`, or JSON under a name that ends in .gltf or with an `asset` in its head.
bool isGltfScene(const std::filesystem::path&, std::string_view head);

void importGltf(const std::filesystem::path&, Import&);

// What a file offers, whether or not an import takes it. Unnamed ones are called by their place: "cameras[0]".
struct GltfContents {
    struct Animation {
        std::string name;
        double first = 0, last = 0; // s, of its keys
    };
    struct Morph {
        std::string mesh;
        std::size_t targets = 0;
    };
    struct Skin {
        std::string name;
        std::size_t joints = 0;
    };
    std::vector<Animation> animations;
    std::vector<std::string> variants; // of materials
    std::vector<std::string> cameras;
    std::vector<Skin> skins;
    std::vector<Morph> morphs; // meshes with targets
};
// Throws IoError.
GltfContents gltfContents(const std::filesystem::path&);

} // namespace abbe::exchange

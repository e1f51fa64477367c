// Scenes of glTF 2.0, as text or binary: one file of nodes, and the buffers and images that it names
// (docs/importing_gltf.md).
#pragma once

#include "exchange/shared/import.h"

#include <filesystem>
#include <string_view>

namespace abbe::exchange {

// Whether a file begins as one: `glTF`, or JSON under a name that ends in .gltf or with an `asset` in its head.
bool isGltfScene(const std::filesystem::path&, std::string_view head);

void importGltf(const std::filesystem::path&, Import&);

} // namespace abbe::exchange

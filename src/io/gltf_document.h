// The JSON and the buffers of glTF files.
#pragma once

#include "io/file.h"
#include "math/transform.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace abbe {

struct GltfFault {
    std::size_t byte;
    std::string what;
};

bool isBinaryGltf(std::string_view bytes);

// Checks the header and the chunks of a binary file, and that the JSON nests less than 256 levels deep: the libraries
// that read it recurse.
std::optional<GltfFault> findContainerFault(std::string_view bytes);

} // namespace abbe

// An opened glTF file: what the library read, checked access to it, and the nodes of the scene with their transforms.

// The library's header brings its own copies of these otherwise.
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <cstdint>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>
#include <vector>

namespace abbe {

// Numbers of an accessor: element i starts at data + i stride.
struct GltfView {
    const unsigned char* data = nullptr; // null: all zeros (sparse accessors without a base)
    std::size_t stride = 0, count = 0;
    int componentType = 0, components = 0;
    bool normalized = false;
};

// One node of the scene, with the map from its space to that of the scene.
struct PlacedGltfNode {
    int node = 0;
    Transform map;
};

// The library checks few of the indices and ranges that it reads; everything here does.
class GltfDocument {
  public:
    // Throws IoError for a damaged container, JSON that the library refuses, and extensions that cannot be honoured.
    GltfDocument(std::string_view bytes, const std::string& name);

    const tinygltf::Model& model() const { return model_; }
    [[noreturn]] void fail(const std::string& what) const;
    // Of the file and of its buffers.
    std::uint64_t bytes() const { return bytes_; }

    // The nodes under the roots of the default scene, or under the node named `root`; parents before children.
    // Throws for cycles, nodes with two parents and wrong transforms.
    std::vector<PlacedGltfNode> nodes(const std::string& root) const;

    // Values of an accessor with 1 to 4 components as float, normalised where it says so; finite. `who` is the JSON
    // path of the reference, for messages.
    std::vector<float> floats(int accessor, int components, const std::string& who) const;
    // Unsigned scalars, each below `limit`.
    std::vector<std::uint32_t> indices(int accessor, std::size_t limit, const std::string& who) const;
    std::size_t count(int accessor, const std::string& who) const;

  private:
    void load(std::string_view bytes);
    void checkExtensions() const;
    const tinygltf::Accessor& accessorAt(int accessor, const std::string& who) const;
    GltfView view(int accessor, const std::string& who) const;
    // A range of a buffer view; all sizes in bytes.
    const unsigned char* range(int bufferView, std::size_t offset, std::size_t stride, std::size_t count,
                               std::size_t element, const std::string& who) const;
    void applySparse(int accessor, const GltfView&, std::vector<float>& values, const std::string& who) const;
    Transform localTransform(int node) const;
    Transform above(int node, const std::vector<int>& parent, std::vector<std::optional<Transform>>& known) const;

    const std::string& name_;
    tinygltf::Model model_;
    std::uint64_t bytes_;
};

} // namespace abbe

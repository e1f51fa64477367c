// The JSON and the buffers of glTF files.
#pragma once

#include "io/file.h"

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

// The file with what the library would refuse, or drop without a word, put into a form that it reads: channels of
// animations without a node (-1), indices without a buffer view beside what Draco unpacks, buffers of nothing but room
// for what meshopt unpacks. Nothing if there is none of it. Requires a file without a fault.
std::optional<std::string> mendedGltf(std::string_view bytes);

// The file's name that a URI stands for, exactly as the library takes it.
std::string decodedGltfUri(const std::string& uri);

} // namespace abbe

// An opened glTF file: what the library read, and checked access to it.

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

// A primitive out of a compressed stream.
struct GltfUnpacked {
    std::size_t vertices = 0;
    std::vector<std::uint32_t> corners; // three for each triangle, each below `vertices`
    struct Attribute {
        std::string name;
        int components = 0;
        std::vector<float> values; // as the accessor's: normalised where it says so; finite
    };
    std::vector<Attribute> attributes;
};

// The library checks few of the indices and ranges that it reads; everything here does.
class GltfDocument {
  public:
    // Throws IoError for a damaged container, JSON that the library refuses, extensions that cannot be honoured, and
    // damaged compressed buffer views. `name` is the path: buffers in files of their own are looked up beside it.
    GltfDocument(std::string_view bytes, std::string name);

    const tinygltf::Model& model() const { return model_; }
    const std::string& name() const { return name_; }
    [[noreturn]] void fail(const std::string& what) const;
    // Of the file and of its buffers.
    std::uint64_t bytes() const { return bytes_; }
    // Accessors may share bytes or have none, and nodes share meshes: what comes out of a file is not bounded by its
    // size. Throws where `elements` are more than 1024 for each byte, and so no work that anybody meant.
    void bound(double elements, const std::string& who) const;

    // Values of an accessor with 1 to 4 components or of a 4 × 4 matrix as float, normalised where it says so; finite.
    // `who` is the JSON path of the reference, for messages.
    std::vector<float> floats(int accessor, int components, const std::string& who) const;
    // Unsigned scalars, each below `limit`.
    std::vector<std::uint32_t> indices(int accessor, std::size_t limit, const std::string& who) const;
    std::size_t count(int accessor, const std::string& who) const { return accessorAt(accessor, who).count; }
    int components(int accessor, const std::string& who) const;
    std::string_view bytesOf(int bufferView, const std::string& who) const;

    // The mesh of a node, or null. Throws for one that is not there.
    const tinygltf::Mesh* meshOf(int node) const;
    const tinygltf::Accessor& accessorAt(int accessor, const std::string& who) const;

  private:
    void load(std::string_view bytes);
    void checkExtensions() const;
    void unpackViews();
    GltfView view(int accessor, const std::string& who) const;
    // A range of a buffer view; all sizes in bytes.
    const unsigned char* range(int bufferView, std::size_t offset, std::size_t stride, std::size_t count,
                               std::size_t element, const std::string& who) const;
    void applySparse(int accessor, const GltfView&, std::vector<float>& values, const std::string& who) const;

    std::string name_;
    tinygltf::Model model_;
    std::uint64_t bytes_;
    std::vector<std::vector<unsigned char>> unpacked_; // by buffer view, empty for those that are not compressed
};

// What KHR_draco_mesh_compression and EXT_meshopt_compression hold. Both take memory by what the stream can hold, and
// throw IoError for damaged ones.

// A primitive with the first extension. `path` is its own in the JSON.
GltfUnpacked unpackDraco(const GltfDocument&, const tinygltf::Primitive&, const std::string& path);
// The bytes of a buffer view with the second, whose members are `extension`.
std::vector<unsigned char> unpackMeshopt(const GltfDocument&, const tinygltf::Value& extension,
                                         const std::string& path);
// Its name in a buffer view, or nothing.
const char* meshoptName(const tinygltf::BufferView&);

} // namespace abbe

// The header of a PLY file: what its body holds, and in what order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

enum class PlyEncoding : std::uint8_t { text, littleEndian, bigEndian };
enum class PlyScalar : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t sizeOf(PlyScalar);

// Where a vertex property goes.
enum class PlyRole : std::uint8_t { none, x, y, z, nx, ny, nz, u, v };
struct PlyProperty {
    std::string name;
    PlyScalar type = PlyScalar::float32;
    std::optional<PlyScalar> listCount; // the type of a list's length
    PlyRole role = PlyRole::none;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::text;
    std::vector<PlyElement> elements; // in the order of the body
    std::size_t bodyOffset = 0;       // in bytes
    std::uint64_t vertexCount = 0;
    bool normals = false, uvs = false; // the vertices have them
};

// What a file must have besides vertices.
enum class PlyContent : std::uint8_t { mesh, points };

// Has vertices with x, y and z, and a mesh's file faces; no count promises more than the bytes can hold. Throws IoError
// with the byte offset of the first fault; `name` is for messages.
PlyHeader parsePlyHeader(std::string_view bytes, const std::string& name, PlyContent = PlyContent::mesh);

} // namespace abbe

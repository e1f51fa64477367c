// The format of PLY files: the header, which says what the body holds and in what order, and the body's numbers.
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
inline constexpr std::size_t kPlyRoles = 9;
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

// Walks through the numbers of a PLY file's body.
// Refers to the header, bytes and name. Every fault is an IoError with the byte offset.
class PlyCursor {
  public:
    PlyCursor(const PlyHeader&, std::string_view bytes, const std::string& name);

    // Throws, with the place of the last number begun.
    [[noreturn]] void fail(const std::string& what) const { failAt(last_, what); }
    // The same, with the place that has been reached.
    [[noreturn]] void failHere(const std::string& what) const { failAt(p_, what); }
    double scalar(PlyScalar);
    // Requires a list; no length promises more than the file holds.
    std::uint64_t listLength(const PlyProperty&);
    void skip(const PlyProperty&);
    void skip(const PlyElement&);

    // Where so many entries of a fixed size lie as this machine has numbers in memory, or null: text, the other byte
    // order, or fewer. pass() goes on behind what was read there, up to end().
    const char* packed(std::uint64_t count, std::size_t size) const {
        return text_ || swap_ || count > left() / size ? nullptr : p_;
    }
    void pass(const char* to) { last_ = p_ = to; }
    const char* end() const { return end_; }

  private:
    [[noreturn]] void failAt(const char*, const std::string& what) const;
    std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - p_); }
    double textScalar();

    const char* begin_;
    const char* p_;
    const char* end_;
    const char* last_; // where the last number begins
    const std::string& name_;
    bool text_, swap_;
};

} // namespace abbe

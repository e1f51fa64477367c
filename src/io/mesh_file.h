// Polygon meshes from files.
#pragma once

#include "io/io_error.h"
#include "math/mesh_data.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace abbe {

// The faces read under one combination of an OBJ file's g, o and usemtl.
struct MeshGroup {
    std::string name;     // of g, or else of o; may be empty
    std::string material; // of usemtl; may be empty
    std::size_t firstTriangle = 0, triangleCount = 0;
    std::size_t firstQuad = 0, quadCount = 0;
};

// What the format itself says about a file's coordinates.
enum class MeshCoordinates : std::uint8_t { unstated, metresYUp };

struct MeshFile {
    MeshData mesh; // indices in range, numbers finite
    MeshCoordinates coordinates = MeshCoordinates::unstated;
    std::vector<MeshGroup> groups;  // in file order, without empty ones; one for PLY
    std::uint64_t ignoredFaces = 0; // points and lines: fewer than three corners
};

// Wavefront OBJ: v, vt, vn, f (negative numbers too), g, o, usemtl; lines, points, s, mtllib and subdivision tags (t)
// are passed over. Vertices are split where faces combine a position with different vt or vn; a corner without vt gets
// (0, 0), one without vn the normal 0. Throws IoError with the line of the first fault.
MeshFile readObj(const std::string& path);
// Stanford PLY, text or binary of either byte order. Throws IoError with the byte offset of the first fault.
MeshFile readPly(const std::string& path);
// Either, or glTF (io/gltf.h), told apart by content.
MeshFile readMesh(const std::string& path);

// The same from memory; `name` is for messages.
MeshFile parseObj(std::string_view text, const std::string& name);
MeshFile parsePly(std::string_view bytes, const std::string& name);

// The faces of one group, with the vertices that they use.
MeshData extractGroup(const MeshFile&, const MeshGroup&);

// No concave polygon with more corners is split (the time grows with the square).
inline constexpr std::size_t kMaxConcaveCorners = 1024;

// Adds a polygon to the mesh: a triangle or a quad as it is (quads turned so that their diagonal lies inside), larger
// ones as triangles, a fan if convex, else by cutting ears. Returns false for a concave polygon that is too large.
// Requires at least three corners, all in range.
bool addPolygon(MeshData&, std::span<const std::uint32_t> corners);

} // namespace abbe

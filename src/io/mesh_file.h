// Polygon meshes and control cages of subdivision surfaces from files.
#pragma once

#include "io/file.h"
#include "math/mesh_data.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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
    std::vector<MeshGroup> groups;         // in file order, without empty ones; one for PLY
    std::uint64_t ignoredFaces = 0;        // points and lines: fewer than three corners
    std::vector<std::string> leftOut = {}; // of glTF: what there is no mesh of, the first ones, each with its place
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

struct CageFile {
    SubdivisionCage cage; // indices of faces in range, numbers finite
    // The runs of faces under one `g`, or else `o`, in file order: each up to the next one's first face.
    struct Group {
        std::string name; // may be empty
        std::size_t firstFace = 0;
    };
    std::vector<Group> groups; // none for PLY
    // Options that the file states itself; the cage has them already.
    bool statesBoundary = false, statesFaceVarying = false, statesCreasing = false;
    std::uint64_t ignoredFaces = 0; // points and lines: fewer than three corners
    std::uint64_t ignoredTags = 0;  // of other renderers' use: hierarchical edits and the like
    std::string ignoredTag;         // the name of the first
};

// Wavefront OBJ with its polygons as they are, texture vertices as face-varying data, and the tags of subdivision
// surfaces, `t name integers/numbers/words …`: crease, corner, hole, interpolateboundary,
// facevaryinginterpolateboundary, creasemethod and smoothtriangles. Tags number vertices and faces from 0. Throws
// IoError with the line of the first fault.
CageFile readObjCage(const std::string& path);
// Stanford PLY; texture coordinates per vertex. Throws IoError with the byte offset of the first fault.
CageFile readPlyCage(const std::string& path);
// Either, told apart by content.
CageFile readCage(const std::string& path);

// The same from memory; `name` is for messages.
CageFile parseObjCage(std::string_view text, const std::string& name);
CageFile parsePlyCage(std::string_view bytes, const std::string& name);

// Applies what stands behind the `t` of a tag to a cage whose faces are known. Returns what is wrong, if anything.
std::optional<std::string> applyObjTag(std::string_view text, CageFile&);

} // namespace abbe

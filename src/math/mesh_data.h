// Polygon meshes and the control cages of subdivision surfaces as files and scenes state them; geometry/ renders them,
// io/ reads them.
#pragma once

#include "math/vec.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

// Numbers or colours at vertices, by name; between vertices they are interpolated.
struct MeshAttribute {
    std::string name;
    int channels = 1;          // 1 or 3
    std::vector<float> values; // `channels` for each vertex, finite
};

// Vertices shared by triangles and quads; counter-clockwise seen from outside. `normals` and `uvs` are per vertex:
// each is empty or as long as `positions`.
struct MeshData {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::array<std::uint32_t, 4>> quads;
    std::vector<MeshAttribute> attributes = {};
};

// Which group of a file each face of a mesh belongs to, by its number in `names`.
struct FaceGroups {
    std::vector<std::string> names; // may repeat, and be empty
    std::vector<std::uint32_t> triangles, quads;
};

// The control cage of a subdivision surface as files and scenes state it; geometry/ dices it, io/ reads it.

// Faces have any number of corners, counter-clockwise seen from outside. Texture coordinates have indices of their own,
// so that a point may have several: seams.
struct SubdivisionCage {
    enum class Scheme : std::uint8_t { catmullClark, loop, bilinear };
    enum class Boundary : std::uint8_t { none, edgeOnly, edgeAndCorner };
    // Where texture coordinates are interpolated linearly instead of smoothly.
    enum class FaceVarying : std::uint8_t { none, cornersOnly, cornersPlus1, cornersPlus2, boundaries, all };
    enum class Creasing : std::uint8_t { uniform, chaikin };

    // A sharpness of 10 or more is infinite.
    struct Crease {
        std::uint32_t a = 0, b = 0; // the ends of an edge
        float sharpness = 10;
    };
    struct Corner {
        std::uint32_t vertex = 0;
        float sharpness = 10;
    };

    std::vector<Vec3> positions;
    std::vector<std::uint32_t> faceSizes;
    std::vector<std::uint32_t> corners; // vertices of all faces, one after the other
    std::vector<Vec2> uvs;
    std::vector<std::uint32_t> uvCorners; // into uvs, like corners; or empty
    std::vector<Crease> creases;
    std::vector<Corner> sharpCorners;
    std::vector<std::uint32_t> holes;      // faces that shape the surface and are left out
    std::vector<MeshAttribute> attributes; // of the points, smoothed as these are

    Scheme scheme = Scheme::catmullClark;
    Boundary boundary = Boundary::edgeAndCorner;
    FaceVarying faceVarying = FaceVarying::cornersPlus1;
    Creasing creasing = Creasing::uniform;
    bool smoothTriangles = false; // better weights for triangles among quads, Catmull-Clark only
};

} // namespace abbe

// The control cage of a subdivision surface as files and scenes state it; geometry/ dices it, io/ reads it.
#pragma once

#include "math/mesh_data.h"

#include <cstdint>
#include <vector>

namespace abbe {

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

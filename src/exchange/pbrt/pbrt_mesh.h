// Meshes of pbrt scenes made fit for the scene language: which side is outside, texture coordinates, files.
#pragma once

#include "exchange/pbrt/pbrt_textures.h"
#include "math/mesh_data.h"

#include <optional>
#include <span>
#include <vector>

namespace abbe::exchange {

// Turns faces so that counter-clockwise is outside, as pbrt has it: that side of a face to which its vertex normals
// point, or else that of its corners; `reversed` exchanges the sides [Pharr2023, sec. 6.5.1].
void pbrtOrient(MeshData&, bool reversed);
// Corners of their own for every face, with the coordinates that pbrt gives to faces without any: (0, 0), (1, 0), (1,
// 1) of triangles, the unit square of quads.
void pbrtSplitWithUvs(MeshData&);
void pbrtMapUvs(MeshData&, const PbrtUv&);
// What is wrong with what a scene states: indices out of range, lengths that do not fit, numbers beyond float.
std::optional<std::string> pbrtMeshFault(const MeshData&);
// The areas of all faces where a transform puts them.
std::vector<double> pbrtFaceAreas(const MeshData&, const Transform&);

struct PbrtRound {
    double radius = 1, zmin = 0, zmax = 0, inner = 0, phimax = 360;
};
// Parts of round shapes as fine meshes with normals and pbrt's texture coordinates; the outer side of a disk faces +z.
MeshData pbrtSphereMesh(const PbrtRound&);
MeshData pbrtCylinderMesh(const PbrtRound&);
MeshData pbrtDiskMesh(const PbrtRound&);
// Patches through four corners each, p00 p10 p01 p11: quads where they are flat, else nets of 8 × 8.
// Returns whether all are flat. Requires four indices a patch, in range.
bool pbrtPatches(const MeshData& corners, std::span<const std::uint32_t> indices, MeshData& out);

} // namespace abbe::exchange

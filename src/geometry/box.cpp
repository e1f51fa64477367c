#include "geometry/box.h"

namespace abbe {

MeshData boxMesh(Vec3d lower, Vec3d upper) {
    MeshData mesh;
    mesh.positions.reserve(8);
    for (int i = 0; i < 8; ++i) // bit 0: x, bit 1: y, bit 2: z
        mesh.positions.push_back(Vec3(Vec3d{(i & 1) != 0 ? upper.x : lower.x, (i & 2) != 0 ? upper.y : lower.y,
                                            (i & 4) != 0 ? upper.z : lower.z}));
    mesh.quads = {{0, 4, 6, 2}, {5, 1, 3, 7}, {0, 1, 5, 4}, {6, 7, 3, 2}, {1, 0, 2, 3}, {4, 5, 7, 6}};
    return mesh;
}

} // namespace abbe

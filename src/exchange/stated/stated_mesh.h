// Shapes as polygons, for formats that lack the shape itself, and the meshes that scenes state.
#pragma once

#include "exchange/stated/stated_scene.h"
#include "math/mesh_data.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe::exchange {

// A mesh in the space of its shape, in m.
struct StatedMesh {
    MeshData mesh;
    std::string file; // an OBJ or PLY file that says the same but for its unit; empty where there is none
    bool obj = false; // of the file
    // Faces with another material than the shape's: the material, and which they are.
    struct Part {
        std::string group;
        MeshData mesh;
        const StatedThing* material = nullptr;
    };
    std::vector<Part> parts; // where not empty, `mesh` has what is left
};

// Of a shape or light that states points or a file: `mesh`, `subdivision` (its cage). Nothing where there is none.
// Throws IoError.
std::optional<StatedMesh> meshOf(const StatedThing&, const StatedScene&);

// Groups of a file whose faces have a material of their own: `material NAME group="left"`.
struct DressedGroups {
    std::string group;
    const StatedThing* material = nullptr;
    std::vector<std::size_t> runs; // indices of `names` with that name, no index twice
};
std::vector<DressedGroups> dressedGroups(const StatedThing&, const std::vector<std::string>& names, const StatedScene&);

// What a subdivision surface states beside its cage goes with being smooth.
void ignoreCage(const StatedThing&);

// Quads, boxes, disks, spheres, cylinders, cones, tori and planes, with normals where they are round and with texture
// coordinates where ours have some that meshes can have. Nothing for other types.
std::optional<MeshData> polygonsOf(const StatedThing&, const StatedScene&);
// Whether polygons only come near the shape.
bool isRound(const StatedThing&);

// The map that takes +y to an axis and the origin to a place.
Transform uprightTo(Vec3d place, Vec3d axis);
// The corners of a quad, counter-clockwise.
std::vector<Vec3d> quadCorners(const StatedThing&);
// Lower and upper corner of a box.
std::pair<Vec3d, Vec3d> boxCorners(const StatedThing&);

// With the map applied, faces outside as they were.
MeshData moved(MeshData, const Transform&);
void splitQuads(MeshData&);
double areaOf(const MeshData&, const Transform& toWorld);

} // namespace abbe::exchange

// `instances OBJECT { … }`: one object at many places, which come from a file, a grid or a surface.
#pragma once

#include "base/diagnostic.h"
#include "math/motion.h"
#include "render/visible_field.h"
#include "schema/type.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

struct InstancesParams : VisibleParams {
    schema::Text points;         // resolved path of a PLY file
    std::optional<Vec3d> grid;   // counts along the axes
    std::optional<double> count; // of `scatter`
    Vec3d spacing{1, 1, 1};
    schema::Text over;         // name of a shape
    std::optional<Vec2d> area; // rectangle about the origin, instead of a shape
    std::int64_t seed = 0;
    double turn = 2 * kPiD;   // rad, at most, about up
    Vec2d scale{1, 1};        // smallest and largest
    bool align = false;       // up becomes the normal of the surface
    KeyedTransform transform; // of all places together
};

schema::TypeInfo instancesType();

// A surface to scatter on: triangles with the sums of their areas, or one disk.
struct ScatterSurface {
    struct Disk {
        Vec3d centre, normal;
        double radius = 0;
    };
    std::vector<std::array<Vec3d, 3>> triangles;
    std::vector<double> areaSums; // of the triangles up to each
    std::optional<Disk> disk;
};

// What says where instances go besides their own properties.
struct PlaceContext {
    Vec3d up{0, 1, 0};
    double unit = 1;                         // m per unit of a file
    const ScatterSurface* surface = nullptr; // for `scatter` over a shape
    Span span;                               // of the definition
};

// Takes the place with a number; false ends the list.
using PlaceVisitor = std::function<bool(std::uint64_t index, const Transform&)>;

// All places in order, each without the params' own transform; the same for the same params on every machine. Returns
// false after an error.
bool visitPlaces(const InstancesParams&, const PlaceContext&, Diagnostics&, const PlaceVisitor&);

} // namespace abbe

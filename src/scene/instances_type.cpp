#include "scene/instances_type.h"

namespace abbe {

using namespace schema;

namespace {

using IP = InstancesParams;

std::vector<FieldInfo> sources() {
    return {
        field<IP, Text>(FieldType::file, "points", &IP::points)
            .group("places")
            .synonyms({"file", "cloud"})
            .doc("PLY file with a place per vertex: x y z; turned by qx qy qz qw or nx ny nz; sized by scale, sx sy sz "
                 "or radius.")
            .example("points \"pebbles.ply\""),
        field<IP, std::optional<Vec3d>>(FieldType::vector3, "grid", &IP::grid)
            .group("places")
            .range(1, 1e8)
            .synonyms({"count", "counts", "array"})
            .doc("Counts along the three axes of a grid about the origin.")
            .example("grid 10 1 10"),
        field<IP, std::optional<double>>(FieldType::integer, "scatter", &IP::count)
            .group("places")
            .range(1, 1e8)
            .synonyms({"number", "random"})
            .doc("This many random places, spread evenly over a shape or an area.")
            .example("scatter 5000"),
    };
}

} // namespace

TypeInfo instancesType() {
    std::vector<FieldInfo> fields = sources();
    const std::vector<FieldInfo> others = {
        field<IP, Vec3d>(FieldType::vector3, "spacing", &IP::spacing)
            .unit({Dimension::length})
            .byDefault("1 1 1")
            .doc("Distances between the places of a grid.")
            .example("spacing 0.5 0.5 0.5 m"),
        field<IP, Text>(FieldType::text, "over", &IP::over)
            .group("surface")
            .synonyms({"on", "surface"})
            .doc("Name of the shape to scatter on, beside these instances: a quad, a disk or anything of polygons.")
            .example("over ground"),
        field<IP, std::optional<Vec2d>>(FieldType::vector2, "area", &IP::area)
            .unit({Dimension::length})
            .range(1e-30, 1e15)
            .group("surface")
            .doc("Width and depth of a level rectangle about the origin to scatter on; 1 1 without `over`.")
            .example("area 20 10 m"),
        field<IP, std::int64_t>(FieldType::integer, "seed", &IP::seed)
            .range(0, 4294967295)
            .byDefault("0")
            .doc("Another number, other random places.")
            .example("seed 7"),
        field<IP, double>(FieldType::quantity, "turn", &IP::turn)
            .unit({Dimension::angle})
            .range(0, 2 * kPiD)
            .byDefault("360 deg")
            .doc("Scattered instances are turned about up by a random angle up to this.")
            .example("turn 30 deg"),
        field<IP, Vec2d>(FieldType::vector2, "scale", &IP::scale)
            .range(1e-9, 1e9)
            .byDefault("1 1")
            .synonyms({"size", "scale-range"})
            .doc("Smallest and largest random size of scattered instances.")
            .example("scale 0.7 1.3"),
        field<IP, bool>(FieldType::toggle, "align", &IP::align)
            .byDefault("off")
            .doc("Scattered instances stand along the normal of the surface, not upright.")
            .example("align on"),
        visibleField<IP>(),
        field<IP, KeyedTransform>(FieldType::transform, "transform", &IP::transform)
            .synonyms({"to_world", "toWorld", "xform"})
            .doc("Moves all places together.")
            .example("transform { translate 0 0.1 0 }"),
    };
    fields.insert(fields.end(), others.begin(), others.end());
    return {Kind::instances,
            "instances",
            "An object at many places.",
            "object pebble { shape sphere { radius 0.02 } }; instances pebble { scatter 1000; area 2 2; seed 3 }",
            true,
            std::move(fields)};
}

} // namespace abbe

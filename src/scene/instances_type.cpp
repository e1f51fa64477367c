#include "io/file.h"
#include "io/ply_points.h"
#include "math/frame.h"
#include "math/joe_kuo.h"
#include "math/sobol.h"
#include "scene/file_faults.h"
#include "scene/instance_builder.h"

#include <algorithm>
#include <fmt/format.h>

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

namespace {

// The rotation of the unit quaternion along (x, y, z, w).
Transform rotationOf(double x, double y, double z, double w) {
    const double s = 2 / (x * x + y * y + z * z + w * w);
    Transform r;
    const double m[3][3] = {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
                            {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
                            {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) r.a[i][j] = m[i][j];
    return r;
}

// The least rotation that takes one unit vector to another; half a turn about any axis between opposite ones.
Transform rotationBetween(Vec3d from, Vec3d to) {
    const double w = 1 + dot(from, to);
    Vec3d axis = cross(from, to);
    if (!(w <= 1e-9)) return rotationOf(axis.x, axis.y, axis.z, w); // not finite if `to` is not
    axis = cross(from, std::abs(from.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0));
    return rotationOf(axis.x, axis.y, axis.z, 0);
}

// --- Points of a file ---

enum Column { x, y, z, qx, qy, qz, qw, nx, ny, nz, sx, sy, sz, scale, radius };
const std::vector<std::string_view> kColumns = {"x",  "y",  "z",  "qx", "qy", "qz",    "qw",    "nx",
                                                "ny", "nz", "sx", "sy", "sz", "scale", "radius"};

// Which of the ways to state something a file has; half a way is a fault.
bool hasAll(const PlyColumns& columns, std::initializer_list<std::string_view> names) {
    std::string_view there, missing;
    for (const std::string_view name : names) (columns.has(name) ? there : missing) = name;
    if (!there.empty() && !missing.empty())
        throw IoError(fmt::format("the points have `{}` but no `{}`", there, missing));
    return missing.empty();
}

struct PointLayout {
    bool quaternions = false, normals = false, sizes = false;
    int size = -1; // the column of a size alike in all directions
};

PointLayout layoutOf(const PlyColumns& columns) {
    PointLayout layout;
    layout.quaternions = hasAll(columns, {"qx", "qy", "qz", "qw"});
    layout.normals = hasAll(columns, {"nx", "ny", "nz"}) && !layout.quaternions;
    layout.sizes = hasAll(columns, {"sx", "sy", "sz"});
    if (columns.has("scale")) layout.size = scale;
    if (layout.size < 0 && columns.has("radius")) layout.size = radius;
    if (layout.sizes && columns.has("scale")) throw IoError("the points have both `scale` and `sx`");
    if (layout.sizes) layout.size = -1;
    return layout;
}

Transform placementOf(const PointLayout& layout, std::span<const double> v, const PlaceContext& context) {
    Transform place;
    if (layout.sizes) place = Transform::scale({v[sx], v[sy], v[sz]});
    if (layout.size >= 0) {
        const double s = v[static_cast<std::size_t>(layout.size)];
        place = Transform::scale({s, s, s});
    }
    if (layout.quaternions) place = place.then(rotationOf(v[qx], v[qy], v[qz], v[qw]));
    if (layout.normals) place = place.then(rotationBetween(context.up, normalize(Vec3d(v[nx], v[ny], v[nz]))));
    place.t = Vec3d(v[x], v[y], v[z]) * context.unit;
    return place;
}

bool visitPoints(const InstancesParams& p, const PlaceContext& context, Diagnostics& diagnostics,
                 const PlaceVisitor& visit) {
    PointLayout layout;
    const auto begin = [&](const PlyColumns& columns) { layout = layoutOf(columns); };
    return readsFile(p.points.value, p.points.span, diagnostics, [&] {
        visitPlyVertices(readFileBytes(p.points.value), p.points.value, kColumns, begin,
                         [&](std::uint64_t i, std::span<const double> v) {
                             return visit(i, placementOf(layout, v, context)); // a turn by nothing makes it not finite
                         });
    });
}

// --- Grids ---

bool visitGrid(const InstancesParams& p, const PlaceVisitor& visit) {
    const auto nx = static_cast<std::uint64_t>(p.grid->x), ny = static_cast<std::uint64_t>(p.grid->y),
               nz = static_cast<std::uint64_t>(p.grid->z);
    const Vec3d middle = (*p.grid - Vec3d(1, 1, 1)) * 0.5;
    std::uint64_t index = 0;
    for (std::uint64_t k = 0; k < nz; ++k)
        for (std::uint64_t j = 0; j < ny; ++j)
            for (std::uint64_t i = 0; i < nx; ++i) {
                const Vec3d cell(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
                if (!visit(index++, Transform::translate(multiply(cell - middle, p.spacing)))) return true;
            }
    return true;
}

// --- Scattering ---

struct SurfacePoint {
    Vec3d p, normal;
};

SurfacePoint pointOn(const ScatterSurface& s, double u, double v, double w) {
    if (s.disk) {
        const Frame frame = Frame::fromNormal(Vec3(s.disk->normal));
        const double r = s.disk->radius * std::sqrt(v), phi = 2 * kPiD * w;
        const Vec3d offset = Vec3d(frame.x) * (r * std::cos(phi)) + Vec3d(frame.y) * (r * std::sin(phi));
        return {s.disk->centre + offset, s.disk->normal};
    }
    const double target = u * s.areaSums.back();
    const auto found = std::ranges::upper_bound(s.areaSums, target);
    const std::size_t i = std::min(static_cast<std::size_t>(found - s.areaSums.begin()), s.triangles.size() - 1);
    const auto& [a, b, c] = s.triangles[i];
    const double root = std::sqrt(v);
    return {a * (1 - root) + b * (root * (1 - w)) + c * (root * w), normalize(cross(b - a, c - a))};
}

// A level rectangle about the origin.
SurfacePoint pointIn(Vec2d area, Vec3d up, double v, double w) {
    const double a = area.x * (v - 0.5), b = area.y * (w - 0.5);
    return {up.z > 0.5 ? Vec3d(a, b, 0) : Vec3d(a, 0, b), up};
}

// Owen-scrambled Sobol points: random to the eye, but without the heaps and gaps of independent ones.
bool visitScatter(const InstancesParams& p, const PlaceContext& context, const PlaceVisitor& visit) {
    const auto seed = mixLanes(UInt8{} + static_cast<std::uint32_t>(p.seed))[0];
    const auto count = static_cast<std::uint32_t>(*p.count);
    for (std::uint32_t i = 0; i < count; ++i) {
        alignas(32) float u[8];
        joeKuoPoint(i, seed, u);
        const auto d = [&u](int k) { return static_cast<double>(u[k]); };
        const SurfacePoint at = context.surface ? pointOn(*context.surface, d(2), d(0), d(1))
                                                : pointIn(p.area.value_or(Vec2d{1, 1}), context.up, d(0), d(1));
        const double size = lerp(p.scale.x, p.scale.y, d(4));
        Transform place = Transform::rotate(context.up, p.turn * d(3)).then(Transform::scale({size, size, size}));
        if (p.align) place = place.then(rotationBetween(context.up, at.normal));
        place.t = at.p;
        if (!visit(i, place)) return true;
    }
    return true;
}

} // namespace

bool visitPlaces(const InstancesParams& p, const PlaceContext& context, Diagnostics& diagnostics,
                 const PlaceVisitor& visit) {
    const bool whole = !p.grid || *p.grid == Vec3d(std::floor(p.grid->x), std::floor(p.grid->y), std::floor(p.grid->z));
    if (!whole || (!p.count && (p.area || !p.over.value.empty()))) {
        diagnostics.error("E0630", context.span,
                          whole ? "`over` and `area` belong to `scatter`" : "the counts of `grid` are whole numbers",
                          "in here");
        return false;
    }
    if (!p.points.value.empty()) return visitPoints(p, context, diagnostics, visit);
    if (p.grid) return visitGrid(p, visit);
    if (p.count) return visitScatter(p, context, visit);
    diagnostics.error("E0630", context.span, "these instances have no places", "says what is placed, but not where")
        .help = "give `points \"file.ply\"`, `grid 10 1 10` or `scatter 1000`";
    return false;
}

} // namespace abbe

#include "scene/shape_parametric.h"

#include "geometry/box.h"
#include "geometry/frustum.h"
#include "geometry/torus.h"
#include "scene/scene_builder.h"
#include "scene/shape_fields.h"

namespace abbe {

using namespace schema;

namespace {

// Thinner tubes drown in the rounding of the quartic.
constexpr double kThinnestTube = 1e-5;

template <typename P>
FieldInfo lengthField(std::string_view name, double P::*member, double least, std::string byDefault,
                      std::string_view doc, std::string_view example, std::vector<std::string_view> synonyms) {
    return field<P, double>(FieldType::quantity, name, member)
        .unit({Dimension::length})
        .range(least, 1e15)
        .byDefault(std::move(byDefault))
        .synonyms(std::move(synonyms))
        .doc(doc)
        .example(example);
}

template <typename P> FieldInfo axisField() {
    return field<P, std::optional<Vec3d>>(FieldType::vector3, "axis", &P::axis)
        .unit({Dimension::none})
        .synonyms({"direction", "normal"})
        .doc("Direction of the axis, of any length; up when absent.")
        .example("axis 0 1 0");
}

template <typename P> FieldInfo capsField() {
    return field<P, bool>(FieldType::toggle, "caps", &P::caps)
        .byDefault("on")
        .synonyms({"closed", "capped"})
        .doc("Whether flat disks close the ends.")
        .example("caps off");
}

FieldInfo cornerField(std::string_view name, std::optional<Vec3d> BoxParams::*member, std::string_view doc,
                      std::string_view example) {
    return field<BoxParams, std::optional<Vec3d>>(FieldType::vector3, name, member)
        .unit({Dimension::length})
        .doc(doc)
        .example(example);
}

TypeInfo boxType() {
    using P = BoxParams;
    std::vector<FieldInfo> fields = {
        centerField<P>("Centre; not beside `min` and `max`."),
        field<P, std::optional<Vec3d>>(FieldType::vector3, "size", &P::size)
            .unit({Dimension::length})
            .range(1e-30, 1e15)
            .synonyms({"dimensions", "extent"})
            .doc("Lengths of the edges along x, y and z; 1 1 1 when absent.")
            .example("size 20 10 30 cm"),
        cornerField("min", &P::min, "Corner with the smallest coordinates, instead of `size`.", "min -1 0 -1"),
        cornerField("max", &P::max, "Corner with the largest coordinates, together with `min`.", "max 1 2 1"),
    };
    addShapeFields<P>(fields);
    return {Kind::shape,      "box", "Box of six flat faces.", "shape box { size 2 1 1; material diffuse }", false,
            std::move(fields)};
}

TypeInfo cylinderType() {
    using P = CylinderParams;
    std::vector<FieldInfo> fields = {
        centerField<P>("Middle, half the height up the axis."),
        axisField<P>(),
        lengthField<P>("radius", &P::radius, 1e-30, "0.5", "Radius.", "radius 0.5 m", {"r"}),
        lengthField<P>("height", &P::height, 1e-30, "1", "Length along the axis.", "height 1 m", {"length", "h"}),
        capsField<P>(),
    };
    addShapeFields<P>(fields);
    return {Kind::shape, "cylinder",       "Exact round cylinder.", "shape cylinder { radius 0.3; height 2 }",
            false,       std::move(fields)};
}

TypeInfo coneType() {
    using P = ConeParams;
    std::vector<FieldInfo> fields = {
        centerField<P>("Middle, half the height up the axis."),
        axisField<P>(),
        lengthField<P>("radius", &P::radius, 0, "0.5", "Radius of the bottom.", "radius 0.5 m", {"r", "bottom-radius"}),
        lengthField<P>("top-radius", &P::topRadius, 0, "0", "Radius of the top; above 0 the cone is truncated.",
                       "top-radius 0.2 m", {"radius2"}),
        lengthField<P>("height", &P::height, 1e-30, "1", "Length along the axis.", "height 1 m", {"length", "h"}),
        capsField<P>(),
    };
    addShapeFields<P>(fields);
    return {
        Kind::shape, "cone",           "Exact round cone, pointed or truncated.", "shape cone { radius 0.5; height 1 }",
        false,       std::move(fields)};
}

TypeInfo torusType() {
    using P = TorusParams;
    std::vector<FieldInfo> fields = {
        centerField<P>("Centre."),
        axisField<P>(),
        lengthField<P>("major-radius", &P::majorRadius, 1e-30, "0.5", "Radius of the circle that the tube follows.",
                       "major-radius 0.5 m", {"radius", "R"}),
        lengthField<P>("minor-radius", &P::minorRadius, 1e-30, "0.125", "Radius of the tube, at most the major radius.",
                       "minor-radius 0.1 m", {"tube-radius", "r"}),
    };
    addShapeFields<P>(fields);
    return {Kind::shape,
            "torus",
            "Exact torus: a ring with a round tube.",
            "shape torus { major-radius 0.5; minor-radius 0.1 }",
            false,
            std::move(fields)};
}

// Turns the y axis to `axis`, moves the origin to `center`.
Transform uprightAt(Vec3d center, Vec3d axis) {
    const Vec3d a = normalize(axis), y{0, 1, 0}, across = cross(y, a);
    const double sine = length(across), angle = std::atan2(sine, dot(y, a));
    const Vec3d hinge = sine > 0 ? across : Vec3d{1, 0, 0};
    return Transform::rotate(hinge, angle).then(Transform::translate(center));
}

std::optional<std::string> boxFault(const BoxParams& p) {
    if (p.size && (p.min || p.max)) return "a box has a `size` or two corners, not both";
    if (p.min.has_value() != p.max.has_value()) return "`min` and `max` of a box belong together";
    if (p.min && !(p.min->x < p.max->x && p.min->y < p.max->y && p.min->z < p.max->z))
        return "`min` of a box lies below `max` in x, y and z";
    if (p.min && length(p.center) > 0) return "`min` and `max` place a box without `center`";
    return std::nullopt;
}

bool soundAxis(const std::optional<Vec3d>& axis, Span span, Diagnostics& diagnostics) {
    if (!axis || length(*axis) > 0) return true;
    diagnostics.error("E0604", span, "`axis` has no direction", "its length is 0");
    return false;
}

// Calls make(map) for the map to render space, unless it flattens the shape or moves it too far away.
template <typename Make>
std::unique_ptr<const Shape> placeParametric(const Transform& map, Span span, Diagnostics& diagnostics, Make make) {
    if (!map.isFinite() || !map.inverse()) {
        diagnostics.error("E0604", span, "the shape's transform leaves it no volume", "flattened");
        return nullptr;
    }
    std::unique_ptr<const Shape> shape = make(map);
    const Bounds3 b = shape->bounds();
    if (isFinite(b.lower) && isFinite(b.upper) &&
        std::max(maxComponent(abs(b.lower)), maxComponent(abs(b.upper))) < 1e15f)
        return shape;
    diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
    return nullptr;
}

} // namespace

std::vector<TypeInfo> parametricTypes() { return {boxType(), cylinderType(), coneType(), torusType()}; }

void SceneBuilder::loadBox(const Definition& d, LoadedShape& shape) {
    const auto p = bound<BoxParams>(d);
    if (!p) return;
    if (const auto fault = boxFault(*p)) {
        diagnostics_.error("E0614", d.span, *fault).help = "`size 1 2 1` with `center`, or `min 0 0 0; max 1 2 1`";
        return;
    }
    const Vec3d size = p->min ? *p->max - *p->min : p->size.value_or(Vec3d{1, 1, 1});
    const Vec3d center = p->min ? (*p->min + *p->max) * 0.5 : p->center;
    shape.common = *p;
    shape.mesh = std::make_shared<const MeshData>(boxMesh(size * -0.5, size * 0.5));
    shape.sound = true;
    shape.meshOrigin = center;
    shape.place = [this, &shape, span = d.span](const Transform& t) {
        return placeMesh(*shape.mesh, Transform::translate(shape.meshOrigin).then(t), span, diagnostics_);
    };
}

void SceneBuilder::loadFrustum(const Definition& d, LoadedShape& shape, Vec3d up) {
    ConeParams p;
    if (d.type->name == "cone") {
        const auto cone = bound<ConeParams>(d);
        if (!cone) return;
        p = *cone;
    } else {
        const auto cylinder = bound<CylinderParams>(d);
        if (!cylinder) return;
        static_cast<ShapeParams&>(p) = *cylinder;
        p.center = cylinder->center;
        p.axis = cylinder->axis;
        p.radius = p.topRadius = cylinder->radius;
        p.height = cylinder->height;
        p.caps = cylinder->caps;
    }
    if (!soundAxis(p.axis, d.span, diagnostics_)) return;
    if (!(p.radius + p.topRadius > 0)) {
        diagnostics_.error("E0604", d.span, "`cone` has no area", "both of its radii are 0");
        return;
    }
    shape.common = p;
    if (!p.caps) shape.openBecause = "without its caps it has no inside";
    shape.sound = true;
    const Transform upright = uprightAt(p.center, p.axis.value_or(up));
    shape.place = [this, p, upright, span = d.span](const Transform& t) {
        return placeParametric(upright.then(t), span, diagnostics_, [&p](const Transform& map) {
            return std::make_unique<Frustum>(p.radius, p.topRadius, p.height, p.caps, map);
        });
    };
}

void SceneBuilder::loadTorus(const Definition& d, LoadedShape& shape, Vec3d up) {
    const auto p = bound<TorusParams>(d);
    if (!p || !soundAxis(p->axis, d.span, diagnostics_)) return;
    if (!(p->minorRadius <= p->majorRadius) || !(p->minorRadius >= kThinnestTube * p->majorRadius)) {
        const bool thick = p->minorRadius > p->majorRadius;
        diagnostics_
            .error("E0613", d.span,
                   thick ? "the tube of a torus is wider than its ring, so that it crosses itself"
                         : "the tube of a torus is thinner than 1e-5 of its ring")
            .help = "`minor-radius` is at most `major-radius`, and at least 1e-5 of it";
        return;
    }
    shape.common = *p;
    shape.sound = true;
    const Transform upright = uprightAt(p->center, p->axis.value_or(up));
    shape.place = [this, major = p->majorRadius, minor = p->minorRadius, upright, span = d.span](const Transform& t) {
        return placeParametric(upright.then(t), span, diagnostics_,
                               [=](const Transform& map) { return std::make_unique<Torus>(major, minor, map); });
    };
}

bool SceneBuilder::loadParametric(const Definition& d, LoadedShape& shape, Vec3d up) {
    const std::string_view type = d.type ? d.type->name : "";
    if (type == "box")
        loadBox(d, shape);
    else if (type == "cylinder" || type == "cone")
        loadFrustum(d, shape, up);
    else if (type == "torus")
        loadTorus(d, shape, up);
    else
        return false;
    return true;
}

} // namespace abbe

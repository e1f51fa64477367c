#include "geometry/frustum.h"

#include "geometry/shape_params.h"
#include "math/warp.h"

#include <array>

namespace abbe {

namespace {

template <typename P> schema::FieldInfo capsField() {
    return schema::field<P, bool>(schema::FieldType::toggle, "caps", &P::caps)
        .byDefault("on")
        .synonyms({"closed", "capped"})
        .doc("Whether flat disks close the ends.")
        .example("caps off");
}

double turns(double x, double z) {
    const double t = std::atan2(x, z) / (2 * kPiD);
    return t < 0 ? t + 1 : t;
}

// The part of a line between two planes y = ±h; from > to if there is none.
struct LinePart {
    double from, to;
};
LinePart slab(double y, double dy, double h) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (dy == 0) return std::abs(y) <= h ? LinePart{-infinity, infinity} : LinePart{infinity, -infinity};
    const double a = (-h - y) / dy, b = (h - y) / dy;
    return {std::min(a, b), std::max(a, b)};
}

// x² + z² - ρ² along the line o + t d is a t² + 2 b t + c, for the radius ρ = rho + slope·dy t.
struct SideQuadratic {
    SideQuadratic(Vec3d o, Vec3d d, double rho, double slope) {
        const double k = slope * d.y;
        a = d.x * d.x + d.z * d.z - k * k;
        b = o.x * d.x + o.z * d.z - k * rho;
        c = o.x * o.x + o.z * o.z - rho * rho;
        // b² - a c without its cancellation: |rho d - k o|² - (o × d)², in the plane across the axis.
        const double wx = rho * d.x - k * o.x, wz = rho * d.z - k * o.z;
        const double w = std::hypot(wx, wz), across = std::abs(o.x * d.z - o.z * d.x);
        discriminant = (w - across) * (w + across);
    }
    bool inside(double t) const { return (a * t + 2 * b) * t + c <= 0; }

    double a, b, c, discriminant;
};

// The roots within the interval, ascending.
struct Roots {
    std::array<double, 2> t;
    int count = 0;
};
Roots rootsWithin(const SideQuadratic& f, LinePart in) {
    Roots roots;
    if (!(f.discriminant >= 0)) return roots;
    const double q = -(f.b + std::copysign(std::sqrt(f.discriminant), f.b));
    const auto add = [&](double t) {
        if (t >= in.from && t <= in.to && std::isfinite(t)) roots.t[static_cast<std::size_t>(roots.count++)] = t;
    };
    add(q / f.a);
    if (q != 0) add(f.c / q);
    if (roots.count == 2 && roots.t[0] > roots.t[1]) std::swap(roots.t[0], roots.t[1]);
    return roots;
}

} // namespace

Frustum::Frustum(double bottom, double top, double height, bool closed, const Transform& toRender)
    : ParametricShape(toRender), bottom_(bottom), top_(top), halfHeight_(height / 2), slope_((top - bottom) / height),
      closed_(closed), reach2_((square(std::max(bottom, top)) + square(height / 2)) * (1 + 1e-9)) {
    const double slant = std::hypot(height, top - bottom);
    sideNormal_ = {height / slant, (bottom - top) / slant};
    sideArea_ = kPiD * (bottom + top) * slant;
    capAreas_[0] = closed ? kPiD * square(bottom) : 0;
    capAreas_[1] = closed ? kPiD * square(top) : 0;
    Bounds3d bounds = circleBounds(-halfHeight_, bottom, 0);
    bounds.add(circleBounds(halfHeight_, top, 0));
    finish(bounds, sideArea_ + capAreas_[0] + capAreas_[1], areaUnderMap());
}

double Frustum::areaUnderMap() const {
    const double caps = capAreas_[0] + capAreas_[1];
    if (const auto s = uniformStretch()) return *s * (sideArea_ + caps);
    // The side's normal depends on the longitude alone, and periodic integrands converge at once.
    constexpr int steps = 4096;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double phi = 2 * kPiD * (i + 0.5) / steps;
        sum += stretch({sideNormal_.x * std::sin(phi), sideNormal_.y, sideNormal_.x * std::cos(phi)});
    }
    return sideArea_ * sum / steps + caps * stretch({0, 1, 0});
}

double Frustum::radiusAt(double y) const {
    return y < 0 ? bottom_ + slope_ * (y + halfHeight_) : top_ + slope_ * (y - halfHeight_);
}

std::optional<ParametricShape::LocalHit> Frustum::intersectLocal(Vec3d origin, Vec3d d, double tMax) const {
    // From the point of the line nearest to the centre all numbers are of the size of the shape.
    const double shift = -dot(origin, d);
    const Vec3d o = origin + d * shift;
    if (!(lengthSquared(o) <= reach2_)) return std::nullopt;
    const LinePart between = slab(o.y, d.y, halfHeight_);
    if (!(between.from <= between.to)) return std::nullopt;
    // The solid is convex: the line is inside from one t to another. Both come from the same few numbers, so no ray
    // slips through the edge where side and cap meet.
    const SideQuadratic f(o, d, bottom_ + slope_ * (o.y + halfHeight_), slope_);
    const Roots roots = rootsWithin(f, between);
    const bool fromCap = std::isfinite(between.from) && f.inside(between.from);
    const bool toCap = std::isfinite(between.to) && f.inside(between.to);
    if (!fromCap && roots.count == 0) return std::nullopt;
    const double enter = fromCap ? between.from : roots.t[0];
    const double leave = toCap              ? between.to
                         : roots.count == 0 ? enter
                                            : roots.t[static_cast<std::size_t>(roots.count - 1)];
    const auto hit = [&](double at, bool cap, Part which) -> std::optional<LocalHit> {
        const double t = at + shift;
        if (!(t > 0) || !(t <= tMax) || (cap && !closed_)) return std::nullopt;
        return LocalHit{t, cap ? which : side};
    };
    const bool rising = d.y > 0;
    if (const auto first = hit(enter, fromCap, rising ? bottomCap : topCap)) return first;
    return hit(leave, toCap, rising ? topCap : bottomCap);
}

ParametricShape::LocalPoint Frustum::sidePoint(double longitude, double y) const {
    const double s = std::sin(longitude), c = std::cos(longitude), r = radiusAt(y);
    const double turn = longitude / (2 * kPiD);
    return {{r * s, y, r * c},
            {sideNormal_.x * s, sideNormal_.y, sideNormal_.x * c},
            {c, 0, -s},
            {turn < 0 ? turn + 1 : turn, 0.5 + y / (2 * halfHeight_)}};
}

ParametricShape::LocalPoint Frustum::capPoint(Part part, double x, double z) const {
    const double up = part == topCap ? 1 : -1, radius = part == topCap ? top_ : bottom_, l = std::hypot(x, z);
    return {{x, up * halfHeight_, z},
            {0, up, 0},
            l > 0 ? Vec3d(x / l, 0, z / l) : Vec3d(0, 0, 1),
            {radius > 0 ? std::min(1.0, l / radius) : 0, turns(x, z)}};
}

ParametricShape::LocalPoint Frustum::project(Vec3d p, int part) const {
    if (part != side) return capPoint(static_cast<Part>(part), p.x, p.z);
    return sidePoint(std::atan2(p.x, p.z), std::clamp(p.y, -halfHeight_, halfHeight_));
}

ParametricShape::LocalDerivatives Frustum::derivatives(const LocalPoint& at, int part) const {
    const Vec3d around = Vec3d(at.p.z, 0, -at.p.x) * (2 * kPiD);
    if (part != side) return {at.tangent * (part == topCap ? top_ : bottom_), around};
    const double rise = top_ - bottom_; // outwards is (-tangent.z, 0, tangent.x)
    return {around, {-at.tangent.z * rise, 2 * halfHeight_, at.tangent.x * rise}};
}

ParametricShape::LocalPoint Frustum::sampleLocal(Vec2d u) const {
    double x = u.x * (sideArea_ + capAreas_[0] + capAreas_[1]);
    if (x < sideArea_) {
        // The radius where a share x of the area lies below it is the root of a mean of squares.
        x /= sideArea_;
        const double r = std::sqrt(lerp(square(bottom_), square(top_), x));
        const double share = r + bottom_ > 0 ? x * (bottom_ + top_) / (r + bottom_) : 0;
        return sidePoint(2 * kPiD * u.y, (2 * std::min(share, 1.0) - 1) * halfHeight_);
    }
    x -= sideArea_;
    const bool top = !(x < capAreas_[0]);
    const double within = top ? (x - capAreas_[0]) / capAreas_[1] : x / capAreas_[0];
    const double r = (top ? top_ : bottom_) * std::sqrt(std::clamp(within, 0.0, 1.0)), phi = 2 * kPiD * u.y;
    return capPoint(top ? topCap : bottomCap, r * std::sin(phi), r * std::cos(phi));
}

schema::TypeInfo cylinderType() {
    using namespace schema;
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

schema::TypeInfo coneType() {
    using namespace schema;
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

std::optional<UnplacedShape> makeCone(const ConeParams& params, const ShapeContext& context) {
    if (!checkAxis(params.axis, context)) return std::nullopt;
    if (!(params.radius + params.topRadius > 0)) {
        context.diagnostics.error("E0604", context.span, "`cone` has no area", "both of its radii are 0");
        return std::nullopt;
    }
    const Transform upright = uprightAt(params.center, params.axis.value_or(context.up));
    UnplacedShape shape;
    if (!params.caps) shape.openBecause = "without its caps it has no inside";
    shape.place = [params, upright, context](const Transform& place) {
        return placeParametric(upright.then(place), context, [&](const Transform& map) {
            return std::make_unique<Frustum>(params.radius, params.topRadius, params.height, params.caps, map);
        });
    };
    return shape;
}

std::optional<UnplacedShape> makeCylinder(const CylinderParams& params, const ShapeContext& context) {
    ConeParams cone;
    cone.center = params.center;
    cone.axis = params.axis;
    cone.radius = cone.topRadius = params.radius;
    cone.height = params.height;
    cone.caps = params.caps;
    return makeCone(cone, context);
}

} // namespace abbe

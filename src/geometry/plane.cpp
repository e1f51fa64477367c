#include "geometry/plane.h"

#include "geometry/disk.h"
#include "geometry/place_shape.h"
#include "geometry/surface_math.h"

#include <tuple>

namespace abbe {

Plane::Plane(Vec3d point, Vec3d normal) : point_(point), z_(normalize(normal)) {
    const Vec3d guess(Frame::fromNormal(Vec3(z_)).x);
    x_ = normalize(guess - z_ * dot(guess, z_));
    y_ = cross(z_, x_);
    byU_ = toU_ = x_;
    byV_ = toV_ = y_;
}

Plane::Plane(Vec3d point, Vec3d normal, const Transform& place) : Plane(point, normal) {
    std::tie(byU_, byV_) = axesAfter(place, z_);
    const double uu = dot(byU_, byU_), uv = dot(byU_, byV_), vv = dot(byV_, byV_), scale = 1 / (uu * vv - uv * uv);
    toU_ = (byU_ * vv - byV_ * uv) * scale;
    toV_ = (byV_ * uu - byU_ * uv) * scale;
}

Bounds3 Plane::bounds() const {
    // A plane across an axis is thin along it: the box of an axis-aligned floor is flat.
    const auto extent = [](double n) { return 1e15 * safeSqrt(1 - n * n); };
    const Vec3d half(extent(z_.x), extent(z_.y), extent(z_.z));
    const Vec3d margin = (abs(point_) + Vec3d(1e-6, 1e-6, 1e-6)) * 0x1p-20;
    return {Vec3(point_ - half - margin), Vec3(point_ + half + margin)};
}

void Plane::commit(GeometrySink& sink) const { sink.analytic(bounds()); }

std::optional<RawHit> Plane::intersect(const Ray& ray) const {
    const Vec3d o = Vec3d(ray.origin) - point_, d(ray.direction);
    const double t = -dot(o, z_) / dot(d, z_); // parallel: infinite or NaN, refused below
    if (!(t > 0) || !(t <= static_cast<double>(ray.tMax)) || !(t < 1e15)) return std::nullopt;
    return RawHit{.distance = static_cast<float>(t)};
}

void Plane::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d d = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance) - point_;
    const double x = dot(d, x_), y = dot(d, y_);
    const Vec3d p = point_ + x_ * x + y_ * y;
    hit.p = Vec3(p);
    hit.pError = analyticError(p, maxComponent(abs(point_)) + std::abs(x) + std::abs(y));
    hit.ng = Vec3(z_);
    hit.shading = {Vec3(x_), Vec3(y_), Vec3(z_)};
    hit.uv = {static_cast<float>(x), static_cast<float>(y)};
    hit.primitive = 0;
}

void Plane::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d d = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance) - point_;
    hit.uv = {static_cast<float>(dot(d, toU_)), static_cast<float>(dot(d, toV_))};
    hit.dpdu = Vec3(byU_);
    hit.dpdv = Vec3(byV_);
}

double Plane::area() const { return std::numeric_limits<double>::infinity(); }

std::optional<SurfacePatch> Plane::patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept {
    return planarPatch(point_, z_, origin, direction);
}

schema::TypeInfo planeType() {
    using namespace schema;
    using P = PlaneParams;
    std::vector<FieldInfo> fields = {centerField<P>("A point of the plane."), normalField<P>()};
    addShapeFields<P>(fields);
    return {Kind::shape, "plane",          "Infinite plane, the ground by default.", "shape plane { material diffuse }",
            false,       std::move(fields)};
}

UnplacedShape makePlane(const PlaneParams& params, const ShapeContext& context) {
    UnplacedShape shape;
    shape.infinite = true;
    shape.place = [params, context](const Transform& place) -> std::unique_ptr<const Shape> {
        const Vec3d normal = params.normal.value_or(context.up);
        if (!(length(normal) > 0)) return reportNoArea(context.span, context.diagnostics, "normal"), nullptr;
        const Vec3d p = place.point(params.center);
        if (!inReach(p)) return reportOutOfReach(context.span, context.diagnostics), nullptr;
        return std::make_unique<Plane>(p, normalize(place.normal(normal)), place);
    };
    return shape;
}

} // namespace abbe

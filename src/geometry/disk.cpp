#include "geometry/disk.h"

#include "geometry/place_shape.h"
#include "geometry/surface_math.h"
#include "geometry/transformed.h"
#include "math/warp.h"

#include <tuple>

namespace abbe {

std::pair<Vec3d, Vec3d> axesAfter(const Transform& place, Vec3d normal) {
    const auto& a = place.a; // normals went by A⁻ᵀ; they go back by Aᵀ
    const Vec3d own = normalize(Vec3d(a[0][0] * normal.x + a[1][0] * normal.y + a[2][0] * normal.z,
                                      a[0][1] * normal.x + a[1][1] * normal.y + a[2][1] * normal.z,
                                      a[0][2] * normal.x + a[1][2] * normal.y + a[2][2] * normal.z));
    const Vec3d guess(Frame::fromNormal(Vec3(own)).x);
    const Vec3d x = normalize(guess - own * dot(guess, own));
    return {place.vector(x), place.vector(cross(own, x))};
}

Disk::Disk(Vec3d centre, Vec3d normal, double radius)
    : centre_(centre), z_(normalize(normal)), radius_(radius), magnitude_(maxComponent(abs(centre)) + radius) {
    // The float frame only picks a direction; the double one is orthonormal to double precision.
    const Vec3d guess(Frame::fromNormal(Vec3(z_)).x);
    x_ = normalize(guess - z_ * dot(guess, z_));
    y_ = cross(z_, x_);
    textureX_ = x_;
    textureY_ = y_;
}

Disk::Disk(Vec3d centre, Vec3d normal, double radius, const Transform& place) : Disk(centre, normal, radius) {
    std::tie(textureX_, textureY_) = axesAfter(place, z_);
    textureX_ = normalize(textureX_);
    textureY_ = normalize(textureY_);
}

Bounds3 Disk::bounds() const {
    const auto extent = [this](double n) { return radius_ * safeSqrt(1 - n * n); };
    const Vec3d half(extent(z_.x), extent(z_.y), extent(z_.z));
    const Vec3d margin = (abs(centre_) + Vec3d(radius_, radius_, radius_)) * 0x1p-22;
    return {Vec3(centre_ - half - margin), Vec3(centre_ + half + margin)};
}

void Disk::commit(GeometrySink& sink) const { sink.analytic(bounds()); }

std::optional<RawHit> Disk::intersect(const Ray& ray) const {
    const Vec3d o = Vec3d(ray.origin) - centre_, d(ray.direction);
    const double t = -dot(o, z_) / dot(d, z_); // parallel: infinite or NaN, refused below
    if (!(t > 0) || !(t <= static_cast<double>(ray.tMax)) || !std::isfinite(t)) return std::nullopt;
    if (!(lengthSquared(o + d * t) <= radius_ * radius_)) return std::nullopt;
    return RawHit{.distance = static_cast<float>(t)};
}

void Disk::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d d = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance) - centre_;
    const double x = dot(d, x_), y = dot(d, y_);
    const Vec3d p = centre_ + x_ * x + y_ * y;
    hit.p = Vec3(p);
    hit.pError = analyticError(p, magnitude_);
    hit.ng = Vec3(z_);
    hit.shading = {Vec3(x_), Vec3(y_), Vec3(z_)};
    const double turn = std::atan2(y, x) / (2 * kPiD);
    hit.uv = {static_cast<float>(std::sqrt(x * x + y * y) / radius_), static_cast<float>(turn < 0 ? turn + 1 : turn)};
    hit.primitive = 0;
}

void parametrizeDisk(double x, double y, double radius, Vec3d axisX, Vec3d axisY, SurfaceHit& hit) {
    const double l = std::hypot(x, y), turn = std::atan2(y, x) / (2 * kPiD);
    hit.uv = {static_cast<float>(std::min(1.0, l / radius)), static_cast<float>(turn < 0 ? turn + 1 : turn)};
    hit.dpdu = Vec3(l > 0 ? (axisX * x + axisY * y) * (radius / l) : axisX * radius);
    hit.dpdv = Vec3((axisY * x - axisX * y) * (2 * kPiD));
}

void Disk::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d d = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance) - centre_;
    parametrizeDisk(dot(d, textureX_), dot(d, textureY_), radius_, textureX_, textureY_, hit);
}

std::optional<UvPoint> Disk::uvPoint(Vec2 uv) const {
    const double r = radius_ * static_cast<double>(uv.x), turn = 2 * kPiD * static_cast<double>(uv.y);
    const Vec3d p = centre_ + (textureX_ * std::cos(turn) + textureY_ * std::sin(turn)) * r;
    return UvPoint{Vec3(p), analyticError(p, magnitude_), Vec3(z_), static_cast<float>(2 * kPiD * radius_ * r)};
}

std::optional<ShapePoint> Disk::samplePoint(std::uint32_t part, Vec2 u) const {
    const Vec2 q = squareToDisk(u);
    const Vec3d p = centre_ + x_ * (radius_ * static_cast<double>(q.x)) + y_ * (radius_ * static_cast<double>(q.y));
    return ShapePoint{Vec3(p), analyticError(p, magnitude_), Vec3(z_), pdfPoint(part, Vec3(z_))};
}

std::optional<ShapeSample> Disk::sample(const Receiver& from, std::uint32_t part, Vec2 u) const {
    const ShapePoint point = *samplePoint(part, u);
    ShapeSample s{point.p, point.pError, point.ng, 0};
    s.pdfSolidAngle = areaToSolidAngle(point.pdfArea, s.p - from.p, s.ng);
    if (!(s.pdfSolidAngle > 0)) return std::nullopt;
    return s;
}

float Disk::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const {
    return areaToSolidAngle(static_cast<float>(1 / area()), hit.p - from.p, hit.ng);
}

std::optional<SurfacePatch> Disk::patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept {
    return planarPatch(centre_, z_, origin, direction);
}

schema::TypeInfo diskType() {
    using namespace schema;
    using P = DiskParams;
    std::vector<FieldInfo> fields = {centerField<P>("Centre."), normalField<P>(), radiusField<P>()};
    addShapeFields<P>(fields);
    return {
        Kind::shape, "disk",           "Flat round surface.", "shape disk { center 0 2 0; normal 0 -1 0; radius 0.3 }",
        false,       std::move(fields)};
}

std::unique_ptr<const Shape> placeDisk(Vec3d center, Vec3d normal, double radius, const Transform& place, Span span,
                                       Diagnostics& diagnostics) {
    if (!(length(normal) > 0)) return reportNoArea(span, diagnostics, "normal"), nullptr;
    const Vec3d c = place.point(center);
    const auto scale = place.uniformScale();
    if (!inReach(c) || (scale && !(*scale * radius < kLargestCoordinate)))
        return reportOutOfReach(span, diagnostics), nullptr;
    if (scale) return std::make_unique<Disk>(c, normalize(place.normal(normal)), *scale * radius, place);
    return std::make_unique<Transformed>(std::make_unique<Disk>(center, normalize(normal), radius), place);
}

UnplacedShape makeDisk(const DiskParams& params, const ShapeContext& context) {
    UnplacedShape shape;
    shape.openBecause = "it has no inside";
    shape.place = [params, context](const Transform& place) {
        return placeDisk(params.center, params.normal.value_or(context.up), params.radius, place, context.span,
                         context.diagnostics);
    };
    return shape;
}

} // namespace abbe

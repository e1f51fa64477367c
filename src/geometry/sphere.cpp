#include "geometry/sphere.h"

#include "geometry/place_shape.h"
#include "geometry/projected_cap.h"
#include "geometry/surface_math.h"
#include "geometry/transformed.h"
#include "math/warp.h"

namespace abbe {

namespace {

// 1 - cos of the half angle of the cone from a point at distance² d2 > r2, without cancellation
// (docs/hard_cases.md, case 30).
double coneOneMinusCos(double d2, double r2) {
    const double sin2 = r2 / d2, cos2 = (d2 - r2) / d2;
    return sin2 / (1 + std::sqrt(cos2));
}

} // namespace

Sphere::Sphere(Vec3d centre, double radius)
    : centre_(centre), radius_(radius), magnitude_(maxComponent(abs(centre)) + radius) {}

Sphere::Sphere(Vec3d centre, double radius, const Transform& place) : Sphere(centre, radius) {
    x_ = Vec3(normalize(place.vector({1, 0, 0})));
    y_ = Vec3(normalize(place.vector({0, 1, 0})));
    z_ = Vec3(normalize(place.vector({0, 0, 1})));
}

Bounds3 Sphere::bounds() const {
    // Rounded outwards: float bounds must hold the double sphere.
    const Vec3d r(radius_, radius_, radius_);
    const Vec3d margin = (abs(centre_) + r) * 0x1p-22;
    return {Vec3(centre_ - r - margin), Vec3(centre_ + r + margin)};
}

void Sphere::commit(GeometrySink& sink) const { sink.analytic(bounds()); }

std::optional<RawHit> Sphere::intersect(const Ray& ray) const {
    // The discriminant from the distance of the centre to the line, and the roots without cancellation
    // [Haines2019, ch. 7].
    const Vec3d o = Vec3d(ray.origin) - centre_, d(ray.direction);
    const double a = dot(d, d), b = -dot(o, d), r2 = radius_ * radius_;
    const Vec3d perpendicular = o + d * (b / a);
    const double discriminant = r2 - dot(perpendicular, perpendicular);
    if (!(discriminant >= 0)) return std::nullopt;
    const double c = dot(o, o) - r2;
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    double near = q / a, far = near;
    if (q != 0) near = c / q;
    if (near > far) std::swap(near, far);
    const double t = near > 0 ? near : far;
    if (!(t > 0) || t > static_cast<double>(ray.tMax)) return std::nullopt;
    return RawHit{.distance = static_cast<float>(t)};
}

ShapeSample Sphere::at(Vec3d normal) const {
    const Vec3d p = centre_ + normal * radius_;
    return {Vec3(p), analyticError(p, magnitude_), Vec3(normal), 0};
}

void parametrizeSphere(Vec3 n, float radius, Vec3 x, Vec3 y, Vec3 z, SurfaceHit& hit) {
    const float nx = dot(n, x), ny = std::clamp(dot(n, y), -1.f, 1.f), nz = dot(n, z);
    const float longitude = std::atan2(nx, nz) * (0.5f * kInvPi);
    hit.uv = {longitude < 0 ? longitude + 1 : longitude, 1 - std::acos(ny) * kInvPi};
    hit.dpdu = (x * nz - z * nx) * (2 * kPi * radius);
    const float sine = std::hypot(nx, nz);
    if (sine > 0) hit.dpdv = (y * sine - (x * nx + z * nz) * (ny / sine)) * (kPi * radius);
}

void Sphere::parametrize(const RawHit&, const Ray&, SurfaceHit& hit) const {
    parametrizeSphere(hit.ng, static_cast<float>(radius_), x_, y_, z_, hit);
}

void Sphere::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d along = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance);
    const ShapeSample s = at(normalize(along - centre_));
    hit.p = s.p;
    hit.pError = s.pError;
    hit.ng = s.ng;
    const Vec3 n = s.ng;
    const float longitude = std::atan2(n.x, n.z) * (0.5f * kInvPi);
    hit.uv = {longitude < 0 ? longitude + 1 : longitude, 1 - std::acos(std::clamp(n.y, -1.f, 1.f)) * kInvPi};
    hit.shading = Frame::fromNormalTangent(n, {n.z, 0, -n.x});
    hit.primitive = 0;
}

double Sphere::area() const { return 4 * kPiD * radius_ * radius_; }

std::optional<UvPoint> Sphere::uvPoint(Vec2 uv) const {
    const double longitude = 2 * kPiD * static_cast<double>(uv.x), height = kPiD * (1 - static_cast<double>(uv.y));
    const double sine = std::sin(height);
    const Vec3d n = Vec3d(x_) * (sine * std::sin(longitude)) + Vec3d(y_) * std::cos(height) +
                    Vec3d(z_) * (sine * std::cos(longitude));
    const ShapeSample s = at(normalize(n));
    return UvPoint{s.p, s.pError, s.ng, static_cast<float>(2 * square(kPiD * radius_) * std::abs(sine))};
}

std::optional<ShapeSample> Sphere::sample(const Receiver& from, std::uint32_t, Vec2 u) const {
    const Vec3d d = centre_ - Vec3d(from.p);
    const double d2 = lengthSquared(d), r2 = radius_ * radius_;
    if (!(d2 > r2)) {
        ShapeSample s = at(Vec3d(squareToSphere(u)));
        s.pdfSolidAngle = areaToSolidAngle(static_cast<float>(1 / area()), s.p - from.p, s.ng);
        if (!(s.pdfSolidAngle > 0)) return std::nullopt;
        return s;
    }
    if (const auto cap = ProjectedCap::seen(from, d / std::sqrt(d2), d2, r2)) {
        const Vec3d w = cap->direction(u);
        const double along = dot(d, w);
        ShapeSample s = at(normalize(w * (along - safeSqrt(along * along - (d2 - r2))) - d));
        s.pdfSolidAngle = static_cast<float>(cap->pdf(w));
        if (!(s.pdfSolidAngle > 0)) return std::nullopt;
        return s;
    }
    // Uniform in the cone. A direction at angle θ in it meets the sphere first at the point whose normal is at angle α
    // from the axis back to `from`: cos α = sin²θ / sin θmax + cos θ sqrt(1 - sin²θ / sin²θmax) [Pharr2023, ch. 6].
    const double oneMinusCosMax = coneOneMinusCos(d2, r2);
    const double h = static_cast<double>(u.x) * oneMinusCosMax;
    const double sin2 = h * (2 - h), sin2Max = r2 / d2;
    const double cosAlpha = sin2 / std::sqrt(sin2Max) + (1 - h) * safeSqrt(1 - sin2 / sin2Max);
    const double sinAlpha = safeSqrt(1 - cosAlpha * cosAlpha), phi = 2 * kPiD * static_cast<double>(u.y);
    const Vec3d axis = d * (-1 / std::sqrt(d2));
    const Frame frame = Frame::fromNormal(Vec3(axis));
    const Vec3d n =
        Vec3d(frame.x) * (sinAlpha * std::cos(phi)) + Vec3d(frame.y) * (sinAlpha * std::sin(phi)) + axis * cosAlpha;
    ShapeSample s = at(normalize(n));
    s.pdfSolidAngle = static_cast<float>(1 / (2 * kPiD * oneMinusCosMax));
    if (!std::isfinite(s.pdfSolidAngle)) return std::nullopt;
    return s;
}

std::optional<ShapePoint> Sphere::samplePoint(std::uint32_t part, Vec2 u) const {
    const ShapeSample s = at(normalize(Vec3d(squareToSphere(u))));
    return ShapePoint{s.p, s.pError, s.ng, pdfPoint(part, s.ng)};
}

float Sphere::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const {
    const Vec3d d = centre_ - Vec3d(from.p);
    const double d2 = lengthSquared(d), r2 = radius_ * radius_;
    if (!(d2 > r2)) return areaToSolidAngle(static_cast<float>(1 / area()), hit.p - from.p, hit.ng);
    if (const auto cap = ProjectedCap::seen(from, d / std::sqrt(d2), d2, r2))
        return static_cast<float>(cap->pdf(normalize(Vec3d(hit.p) - Vec3d(from.p))));
    const auto pdf = static_cast<float>(1 / (2 * kPiD * coneOneMinusCos(d2, r2)));
    return std::isfinite(pdf) ? pdf : 0;
}

std::optional<SurfacePatch> Sphere::patch(const SurfaceHit& hit, Vec3d origin, Vec3d direction) const noexcept {
    const Vec3d o = origin - centre_;
    const double a = dot(direction, direction), b = -dot(o, direction);
    const Vec3d nearest = o + direction * (b / a);
    const double discriminant = square(radius_) - dot(nearest, nearest);
    if (!(discriminant >= 0)) return std::nullopt;
    const double half = std::sqrt(discriminant / a);
    const bool beyond = dot(Vec3d(hit.p) - centre_ - nearest, direction) > 0;
    const Vec3d n = normalize(nearest + direction * (beyond ? half : -half));
    const auto [x, y] = tangentsOf(n);
    return SurfacePatch{centre_ + n * radius_, n, n, {x, y}, {x / radius_, y / radius_}};
}

schema::TypeInfo sphereType() {
    using namespace schema;
    using P = SphereParams;
    std::vector<FieldInfo> fields = {centerField<P>("Centre."), radiusField<P>()};
    addShapeFields<P>(fields);
    return {Kind::shape, "sphere",         "Exact sphere.", "shape sphere { center 0 0.5 0; radius 0.5 }",
            false,       std::move(fields)};
}

std::unique_ptr<const Shape> placeSphere(Vec3d center, double radius, const Transform& place, Span span,
                                         Diagnostics& diagnostics) {
    const Vec3d c = place.point(center);
    const auto scale = place.uniformScale();
    if (!inReach(c) || (scale && !(*scale * radius < kLargestCoordinate)))
        return reportOutOfReach(span, diagnostics), nullptr;
    if (scale) return std::make_unique<Sphere>(c, *scale * radius, place);
    return std::make_unique<Transformed>(std::make_unique<Sphere>(center, radius), place);
}

UnplacedShape makeSphere(const SphereParams& params, const ShapeContext& context) {
    UnplacedShape shape;
    shape.place = [params, context](const Transform& place) {
        return placeSphere(params.center, params.radius, place, context.span, context.diagnostics);
    };
    return shape;
}

} // namespace abbe

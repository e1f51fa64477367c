#include "geometry/round_shapes.h"

#include "geometry/shape_params.h"
#include "geometry/spherical_sampling.h"
#include "geometry/surface_math.h"
#include "math/warp.h"

#include <tuple>

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
    : Shape({.relief = Relief::smooth}), centre_(centre), radius_(radius),
      magnitude_(maxComponent(abs(centre)) + radius) {}

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

namespace {

// Of a normal in the sphere's own axes.
Vec2 sphereUv(float nx, float ny, float nz) {
    const float longitude = std::atan2(nx, nz) * (0.5f * kInvPi);
    return {longitude < 0 ? longitude + 1 : longitude, 1 - std::acos(ny) * kInvPi};
}

} // namespace

void parametrizeSphere(Vec3 n, float radius, Vec3 x, Vec3 y, Vec3 z, SurfaceHit& hit) {
    const float nx = dot(n, x), ny = std::clamp(dot(n, y), -1.f, 1.f), nz = dot(n, z);
    hit.uv = sphereUv(nx, ny, nz);
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
    const float nx = dot(n, x_), nz = dot(n, z_);
    hit.uv = sphereUv(nx, std::clamp(dot(n, y_), -1.f, 1.f), nz);
    hit.shading = Frame::fromNormalTangent(n, x_ * nz - z_ * nx); // along ∂p/∂u
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
    // Uniform in the cone. A direction at angle θ in it hits the sphere first at the point whose normal is at angle α
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
    : Shape({.relief = Relief::smooth}), centre_(centre), z_(normalize(normal)), radius_(radius),
      magnitude_(maxComponent(abs(centre)) + radius) {
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

namespace {

// Area of the unit sphere's image: the integral of |cof(A) n| over the sphere, by the midpoint rule in height and
// longitude. 256² points give six digits for axis ratios up to 100.
double ellipsoidArea(const Transform& m) {
    constexpr int steps = 256;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double z = (2 * i + 1.0) / steps - 1, r = std::sqrt(1 - z * z);
        for (int j = 0; j < steps; ++j) {
            const double phi = 2 * kPiD * (j + 0.5) / steps;
            sum += length(m.normal({r * std::cos(phi), r * std::sin(phi), z}));
        }
    }
    return 4 * kPiD * sum / (steps * steps);
}

} // namespace

Transformed::Transformed(std::unique_ptr<const Sphere> sphere, const Transform& toRender)
    : Shape({.relief = Relief::smooth}), map_(toRender), inverse_(*map_.map().inverse()),
      determinant_(std::abs(map_.map().determinant())) {
    const Transform& m = map_.map();
    const double r = sphere->radius();
    const auto row = [&m, r](int i) { return r * length(Vec3d(m.a[i][0], m.a[i][1], m.a[i][2])); };
    setBounds(m.point(sphere->centre()), {row(0), row(1), row(2)});
    area_ = r * r * ellipsoidArea(m);
    shape_ = std::move(sphere);
}

Transformed::Transformed(std::unique_ptr<const Disk> disk, const Transform& toRender)
    : Shape({.relief = Relief::smooth}), map_(toRender), inverse_(*map_.map().inverse()),
      determinant_(std::abs(map_.map().determinant())) {
    const Transform& m = map_.map();
    const Vec3d n = disk->normal();
    const double r = disk->radius();
    // Per axis: the row of the matrix without its part along the disk's normal.
    const auto row = [&m, n, r](int i) {
        const Vec3d a(m.a[i][0], m.a[i][1], m.a[i][2]);
        return r * length(a - n * dot(a, n));
    };
    setBounds(m.point(disk->centre()), {row(0), row(1), row(2)});
    area_ = disk->area() * length(m.normal(n));
    shape_ = std::move(disk);
}

void Transformed::setBounds(Vec3d centre, Vec3d halfExtent) {
    const Vec3d margin = (abs(centre) + halfExtent) * 0x1p-20;
    bounds_ = {Vec3(centre - halfExtent - margin), Vec3(centre + halfExtent + margin)};
}

void Transformed::commit(GeometrySink& sink) const { sink.analytic(bounds_); }

std::optional<RawHit> Transformed::intersect(const Ray& ray) const { return shape_->intersect(map_.toObject(ray)); }

void Transformed::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    shape_->surface(raw, map_.toObject(ray), hit);
    map_.toRender(hit);
}

void Transformed::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Ray inside = map_.toObject(ray);
    SurfaceHit own;
    shape_->surface(raw, inside, own);
    shape_->parametrize(raw, inside, own);
    map_.parametrizationToRender(own);
    hit.uv = own.uv;
    hit.dpdu = own.dpdu;
    hit.dpdv = own.dpdv;
}

// dω in object space per dω in render space, for the unit object direction w: |A w|³ / |det A|.
double Transformed::directionJacobian(Vec3 w) const {
    const double l = length(map_.map().vector(Vec3d(w)));
    return l * l * l / determinant_;
}

// A point of the inner shape, in render space.
SurfaceHit Transformed::pointInRender(Vec3 p, Vec3 pError, Vec3 ng) const {
    SurfaceHit hit;
    hit.p = p;
    hit.pError = pError;
    hit.ng = hit.shading.z = ng;
    map_.toRender(hit);
    return hit;
}

std::optional<ShapeSample> Transformed::sample(const Receiver& from, std::uint32_t, Vec2 u) const {
    const Vec3 origin(inverse_.point(Vec3d(from.p)));
    const auto inner = shape_->sampling()->sample(origin, 0, u);
    if (!inner) return std::nullopt;
    const SurfaceHit hit = pointInRender(inner->p, inner->pError, inner->ng);
    const Vec3 w = inner->p - origin;
    const double pdf = static_cast<double>(inner->pdfSolidAngle) * directionJacobian(normalize(w));
    if (!(pdf > 0) || !std::isfinite(static_cast<float>(pdf))) return std::nullopt;
    return ShapeSample{hit.p, hit.pError, hit.ng, static_cast<float>(pdf)};
}

float Transformed::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const {
    const Vec3 origin(inverse_.point(Vec3d(from.p)));
    SurfaceHit inner;
    inner.p = Vec3(inverse_.point(Vec3d(hit.p)));
    inner.ng = Vec3(normalize(inverse_.normal(Vec3d(hit.ng))));
    const Vec3 w = inner.p - origin;
    if (!(lengthSquared(w) > 0)) return 0;
    const double pdf =
        static_cast<double>(shape_->sampling()->pdfSolidAngle(origin, inner)) * directionJacobian(normalize(w));
    return std::isfinite(static_cast<float>(pdf)) ? static_cast<float>(pdf) : 0;
}

std::optional<ShapePoint> Transformed::samplePoint(std::uint32_t part, Vec2 u) const {
    const auto inner = shape_->sampling()->samplePoint(part, u);
    if (!inner) return std::nullopt;
    const SurfaceHit hit = pointInRender(inner->p, inner->pError, inner->ng);
    return ShapePoint{hit.p, hit.pError, hit.ng, pdfPoint(part, hit.ng)};
}

// Own area per render area is 1 / |cof(A) n| for the own normal n, and |cof(A⁻¹) n'| for the one here.
float Transformed::pdfPoint(std::uint32_t part, Vec3 ng) const {
    const Vec3d back = inverse_.normal(Vec3d(ng));
    return static_cast<float>(static_cast<double>(shape_->sampling()->pdfPoint(part, Vec3(normalize(back)))) *
                              length(back));
}

std::optional<UvPoint> Transformed::uvPoint(Vec2 uv) const {
    const auto inner = shape_->sampling()->uvPoint(uv);
    if (!inner) return std::nullopt;
    const SurfaceHit hit = pointInRender(inner->p, inner->pError, inner->ng);
    const double stretch = length(map_.map().normal(Vec3d(inner->ng))); // cofactors: render area per own area
    return UvPoint{hit.p, hit.pError, hit.ng, static_cast<float>(static_cast<double>(inner->area) * stretch)};
}

std::optional<SurfacePatch> Transformed::patch(const SurfaceHit& hit, Vec3d origin, Vec3d direction) const noexcept {
    const Transform& m = map_.map();
    SurfaceHit own;
    own.p = Vec3(inverse_.point(Vec3d(hit.p)));
    const auto inner = shape_->patch(own, inverse_.point(origin), inverse_.vector(direction));
    if (!inner) return inner;
    SurfacePatch patch;
    patch.p = m.point(inner->p);
    const Vec3d across = m.normal(inner->n);
    const double scale = 1 / length(across);
    patch.ng = patch.n = across * scale;
    for (std::size_t i = 0; i < 2; ++i) {
        patch.along[i] = transposed(inverse_, inner->along[i]);  // along · A⁻¹ dp
        const Vec3d turned = m.normal(inner->change[i]) * scale; // and made unit again
        patch.change[i] = turned - patch.n * dot(turned, patch.n);
    }
    return patch;
}

} // namespace abbe

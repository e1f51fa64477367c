#include "geometry/parametric_shape.h"

#include "base/check.h"
#include "geometry/surface_math.h"

namespace abbe {

ParametricShape::ParametricShape(const Transform& toRender)
    : Shape({.relief = Relief::smooth}), map_(toRender), determinant_(std::abs(toRender.determinant())) {
    const auto inverse = toRender.inverse();
    ABBE_CHECK(inverse.has_value());
    inverse_ = *inverse;
}

void ParametricShape::finish(const Bounds3d& b, double localArea, double area) {
    magnitude_ = std::max(maxComponent(abs(b.lower)), maxComponent(abs(b.upper)));
    // Rounded outwards: float bounds must hold the double surface.
    const double margin = magnitude_ * 0x1p-22;
    const Vec3d m(margin, margin, margin);
    bounds_ = {Vec3(b.lower - m), Vec3(b.upper + m)};
    localArea_ = localArea;
    area_ = area;
}

Bounds3d ParametricShape::circleBounds(double y, double radius, double ball) const {
    const auto half = [&](int i) {
        const auto& row = map_.a[i];
        return radius * std::hypot(row[0], row[2]) + ball * length(Vec3d(row[0], row[1], row[2]));
    };
    const Vec3d centre = map_.point({0, y, 0}), extent(half(0), half(1), half(2));
    return {centre - extent, centre + extent};
}

std::optional<double> ParametricShape::uniformStretch() const {
    const auto scale = map_.uniformScale();
    if (!scale) return std::nullopt;
    return square(*scale);
}

void ParametricShape::commit(GeometrySink& sink) const { sink.analytic(bounds_); }

std::optional<RawHit> ParametricShape::intersect(const Ray& ray) const {
    const Vec3d d = inverse_.vector(Vec3d(ray.direction));
    const double l = length(d);
    if (!(l > 0)) return std::nullopt;
    const auto hit = intersectLocal(inverse_.point(Vec3d(ray.origin)), d * (1 / l), l * static_cast<double>(ray.tMax));
    if (!hit) return std::nullopt;
    return RawHit{.u = static_cast<float>(hit->part), .distance = static_cast<float>(hit->t / l)};
}

void ParametricShape::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d along = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance);
    const LocalPoint local = project(inverse_.point(along), static_cast<int>(raw.u));
    const Vec3d p = map_.point(local.p);
    hit.p = Vec3(p);
    hit.pError = analyticError(p, magnitude_);
    hit.ng = Vec3(normalize(map_.normal(local.n)));
    hit.shading = Frame::fromNormalTangent(hit.ng, Vec3(normalize(map_.vector(local.tangent))));
    hit.uv = Vec2{static_cast<float>(local.uv.x), static_cast<float>(local.uv.y)};
    hit.primitive = static_cast<std::uint32_t>(raw.u);
}

void ParametricShape::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d along = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance);
    const int part = static_cast<int>(raw.u);
    const LocalDerivatives d = derivatives(project(inverse_.point(along), part), part);
    hit.dpdu = Vec3(map_.vector(d.byU));
    hit.dpdv = Vec3(map_.vector(d.byV));
}

// Density per area in render space. A⁻ᵀ takes normals there, so that an area with the unit normal n there has grown by
// |det A| / |Aᵀ n|.
double ParametricShape::pdfArea(Vec3d n) const {
    const Vec3d back = transposed(map_, n);
    return length(back) / (determinant_ * localArea_);
}

std::optional<ShapePoint> ParametricShape::samplePoint(std::uint32_t part, Vec2 u) const {
    const LocalPoint local = sampleLocal(Vec2d{static_cast<double>(u.x), static_cast<double>(u.y)});
    const Vec3d p = map_.point(local.p);
    const Vec3 ng(normalize(map_.normal(local.n)));
    return ShapePoint{Vec3(p), analyticError(p, magnitude_), ng, pdfPoint(part, ng)};
}

float ParametricShape::pdfPoint(std::uint32_t, Vec3 ng) const { return static_cast<float>(pdfArea(Vec3d(ng))); }

std::optional<ShapeSample> ParametricShape::sample(const Receiver& from, std::uint32_t, Vec2 u) const {
    const LocalPoint local = sampleLocal(Vec2d{static_cast<double>(u.x), static_cast<double>(u.y)});
    const Vec3d p = map_.point(local.p);
    const Vec3 ng(normalize(map_.normal(local.n)));
    const Vec3 rounded(p);
    const float pdf = areaToSolidAngle(static_cast<float>(pdfArea(Vec3d(ng))), rounded - from.p, ng);
    if (!(pdf > 0)) return std::nullopt;
    return std::optional<ShapeSample>(std::in_place, rounded, analyticError(p, magnitude_), ng, pdf);
}

float ParametricShape::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const {
    return areaToSolidAngle(static_cast<float>(pdfArea(Vec3d(hit.ng))), hit.p - from.p, hit.ng);
}

std::optional<SurfacePatch> ParametricShape::patch(const SurfaceHit& hit, Vec3d origin,
                                                   Vec3d direction) const noexcept {
    constexpr int kSteps = 3; // of Newton's method, from an error of single precision
    const int part = static_cast<int>(hit.primitive);
    const Vec3d o = inverse_.point(origin), d = inverse_.vector(direction);
    const double size = std::sqrt(localArea_);
    LocalPoint at = project(inverse_.point(Vec3d(hit.p)), part);
    Vec3d onLine;
    for (int i = 0; i < kSteps; ++i) {
        const double t = dot(at.p - o, at.n) / dot(d, at.n);
        if (!std::isfinite(t)) return std::nullopt;
        onLine = o + d * t;
        if (!(lengthSquared(onLine - at.p) < square(1e-2 * size))) return std::nullopt; // the line passes by
        at = project(onLine, part);
    }
    if (!(lengthSquared(onLine - at.p) < square(1e-9 * size))) return std::nullopt;
    const auto normal = [&](const LocalPoint& point) { return normalize(map_.normal(point.n)); };
    SurfacePatch patch;
    patch.p = map_.point(at.p);
    patch.ng = patch.n = normal(at);
    // project() is exact, so that differences of its normals are good to 1e-8.
    const double h = 1e-5 * size;
    const auto [x, y] = tangentsOf(at.n);
    const std::array<Vec3d, 2> steps{x, y};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vec3d change = normal(project(at.p + steps[i] * h, part)) - normal(project(at.p - steps[i] * h, part));
        patch.change[i] = (change - patch.n * dot(change, patch.n)) * (0.5 / h);
        patch.along[i] = transposed(inverse_, steps[i]); // steps[i] · A⁻¹ dp
    }
    return patch;
}

} // namespace abbe

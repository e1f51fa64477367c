#include "geometry/transformed.h"

#include "geometry/surface_math.h"

namespace abbe {

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
    : map_(toRender), inverse_(*map_.map().inverse()), determinant_(std::abs(map_.map().determinant())) {
    const Transform& m = map_.map();
    const double r = sphere->radius();
    const auto row = [&m, r](int i) { return r * length(Vec3d(m.a[i][0], m.a[i][1], m.a[i][2])); };
    setBounds(m.point(sphere->centre()), {row(0), row(1), row(2)});
    area_ = r * r * ellipsoidArea(m);
    shape_ = std::move(sphere);
}

Transformed::Transformed(std::unique_ptr<const Disk> disk, const Transform& toRender)
    : map_(toRender), inverse_(*map_.map().inverse()), determinant_(std::abs(map_.map().determinant())) {
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

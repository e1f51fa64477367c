#include "geometry/instance.h"

#include "base/check.h"
#include "geometry/surface_math.h"

namespace abbe {

namespace {

// Coordinates of a ray in object space stay below this times those outside, and the other way round.
constexpr double kLargestScale = 1e15;

// |A| v
Vec3d absoluteVector(const Transform& m, Vec3d v) {
    const auto row = [&](int i) {
        return std::abs(m.a[i][0]) * v.x + std::abs(m.a[i][1]) * v.y + std::abs(m.a[i][2]) * v.z;
    };
    return {row(0), row(1), row(2)};
}

double largestEntry(const Transform& m) {
    double largest = 0;
    for (const auto& row : m.a)
        for (double v : row) largest = std::max(largest, std::abs(v));
    return largest;
}

// Columns of det(A) A⁻ᵀ, which are the rows of the inverse but for the determinant.
struct Cofactors {
    Vec3d x, y, z;
    double determinant;
};
[[gnu::always_inline]] inline Cofactors cofactors(Vec3d c0, Vec3d c1, Vec3d c2) {
    const Vec3d x = cross(c1, c2);
    return {x, cross(c2, c0), cross(c0, c1), dot(c0, x)};
}

// Like Transform::normal, but with the cofactors at hand.
Vec3d mapNormal(const Cofactors& c, Vec3d n) {
    return (c.x * n.x + c.y * n.y + c.z * n.z) * (c.determinant < 0 ? -1.0 : 1.0);
}

// The direction in the surface whose projection along the shading normal is the frame's tangent. Only this one can be
// carried over: after an uneven scale the projections of equal directions differ.
Vec3d tangentInSurface(const SurfaceHit& hit) {
    const Vec3d x(hit.shading.x), n(hit.shading.z), ng(hit.ng);
    const double cosine = dot(n, ng);
    return cosine > 1e-3 ? x - n * (dot(x, ng) / cosine) : x;
}

} // namespace

std::optional<std::string> Placement::findFault(const Transform& m) {
    if (!m.isFinite()) return "it is not finite";
    if (!m.inverse()) return "it flattens the object";
    const Transform rounded = Placement(m).map(); // what will be used must be sound, too
    const auto inverse = rounded.inverse();
    if (!inverse || !rounded.isFinite() || largestEntry(rounded) > kLargestScale ||
        largestEntry(*inverse) > kLargestScale)
        return "it makes the object too small or too large for the numbers of a ray";
    return std::nullopt;
}

Placement::Placement(const Transform& m) {
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) a_[i][j] = static_cast<float>(m.a[i][j]);
        t_[i] = static_cast<float>(m.t[i]);
    }
}

// Out of line, because g++ 12 takes conversions to float and straight back for nothing when it vectorises them.
[[gnu::noinline]] Transform Placement::map() const {
    Transform m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m.a[i][j] = static_cast<double>(a_[i][j]);
    m.t = {static_cast<double>(t_[0]), static_cast<double>(t_[1]), static_cast<double>(t_[2])};
    return m;
}

Ray Placement::toObject(const Ray& ray) const {
    const Vec3 o = ray.origin, d = ray.direction;
    const RayLanes r = toObject(RayLanes{{o.x, o.y, o.z, 0}, {d.x, d.y, d.z, 0}});
    return {
        {r.origin[0], r.origin[1], r.origin[2]}, {r.direction[0], r.direction[1], r.direction[2]}, ray.tMax, ray.time};
}

Bounds3 Placement::toOuter(const Bounds3& b) const {
    if (b.empty()) return {};
    const Transform m = map();
    const Vec3d lower(b.lower), upper(b.upper);
    const Vec3d centre = m.point((lower + upper) * 0.5), half = absoluteVector(m, (upper - lower) * 0.5);
    const Vec3d margin = (absoluteVector(m, max(abs(lower), abs(upper))) + abs(m.t)) * 0x1p-21;
    return {Vec3(centre - half - margin), Vec3(centre + half + margin)};
}

Instance::Instance(const Placement& placement) : objectToRender_(placement.map()) {
    const auto inverse = objectToRender_.inverse();
    ABBE_CHECK(inverse.has_value());
    renderToObject_ = *inverse;
}

Ray Instance::toObject(const Ray& ray) const {
    return {Vec3(renderToObject_.point(Vec3d(ray.origin))), Vec3(renderToObject_.vector(Vec3d(ray.direction))),
            ray.tMax, ray.time};
}

void Instance::toRender(SurfaceHit& hit) const {
    const Transform& m = objectToRender_;
    const Vec3d object(hit.p);
    const Vec3d p = m.point(object);
    const Vec3d t = abs(m.t);
    // Errors of the point itself, of its map, and of the ray in object space, which is what the next ray from here has
    // to clear: |A| |A⁻¹| is how much the rounding of that ray weighs out here (docs/hard_cases.md, case 19).
    const Vec3d map = absoluteVector(m, abs(object)) + t;
    const Vec3d ray = absoluteVector(m, absoluteVector(renderToObject_, abs(p) + t));
    hit.pError = Vec3(absoluteVector(m, Vec3d(hit.pError)) + (map + ray) * static_cast<double>(gammaBound(4)));
    hit.p = Vec3(p);
    const auto column = [&m](int j) { return Vec3d(m.a[0][j], m.a[1][j], m.a[2][j]); };
    const Cofactors c = cofactors(column(0), column(1), column(2));
    const Vec3d tangent = m.vector(tangentInSurface(hit));
    hit.ng = Vec3(normalize(mapNormal(c, Vec3d(hit.ng))));
    Vec3 n = Vec3(normalize(mapNormal(c, Vec3d(hit.shading.z))));
    if (dot(n, hit.ng) < 0) n = -n;
    hit.shading = Frame::fromNormalTangent(n, Vec3(normalize(tangent)));
}

void Instance::parametrizationToRender(SurfaceHit& hit) const {
    hit.dpdu = Vec3(objectToRender_.vector(Vec3d(hit.dpdu)));
    hit.dpdv = Vec3(objectToRender_.vector(Vec3d(hit.dpdv)));
    hit.localScale *= static_cast<float>(std::cbrt(std::abs(renderToObject_.determinant())));
    const auto& a = renderToObject_.a; // gradients go by the transpose of the inverse
    for (Vec3* const gradient : {&hit.localX, &hit.localY, &hit.localZ}) {
        const Vec3d g(*gradient);
        *gradient =
            Vec3(Vec3d(a[0][0] * g.x + a[1][0] * g.y + a[2][0] * g.z, a[0][1] * g.x + a[1][1] * g.y + a[2][1] * g.z,
                       a[0][2] * g.x + a[1][2] * g.y + a[2][2] * g.z));
    }
}

Bounds3 Instance::toRender(const Bounds3& b) const { return Placement(objectToRender_).toOuter(b); }

} // namespace abbe

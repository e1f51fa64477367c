#include "geometry/instance.h"

#include "base/check.h"
#include "geometry/surface_math.h"

namespace abbe {

namespace {

Transform roundedToFloat(Transform m) {
    for (auto& row : m.a)
        for (double& v : row) v = static_cast<float>(v);
    m.t = Vec3d(Vec3(m.t));
    return m;
}

Vec3d multiply(const double (&m)[3][3], Vec3d v) {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

} // namespace

Instance::Instance(const Transform& objectToRender) : objectToRender_(roundedToFloat(objectToRender)) {
    const auto inverse = objectToRender_.inverse();
    ABBE_CHECK(inverse.has_value());
    renderToObject_ = *inverse;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            absolute_[i][j] = std::abs(objectToRender_.a[i][j]);
            roundTrip_[i][j] = 0;
            for (int k = 0; k < 3; ++k)
                roundTrip_[i][j] += std::abs(objectToRender_.a[i][k]) * std::abs(renderToObject_.a[k][j]);
        }
}

std::array<float, 12> Instance::rowMajor() const {
    std::array<float, 12> m;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) m[4 * i + j] = static_cast<float>(objectToRender_.a[i][j]);
        m[4 * i + 3] = static_cast<float>(objectToRender_.t[i]);
    }
    return m;
}

Ray Instance::toObject(const Ray& ray) const {
    return {Vec3(renderToObject_.point(Vec3d(ray.origin))), Vec3(renderToObject_.vector(Vec3d(ray.direction))),
            ray.tMax, ray.time};
}

void Instance::toRender(SurfaceHit& hit) const {
    const Vec3d object(hit.p);
    const Vec3d p = objectToRender_.point(object);
    const Vec3d t = abs(objectToRender_.t);
    // Errors of the point itself, of its map, and of Embree's ray in object space, which is what the next ray from
    // here has to clear (docs/hard_cases.md, case 19).
    const Vec3d map = multiply(absolute_, abs(object)) + t;
    const Vec3d ray = multiply(roundTrip_, abs(p) + t);
    hit.pError = Vec3(multiply(absolute_, Vec3d(hit.pError)) + (map + ray) * static_cast<double>(gammaBound(4)));
    hit.p = Vec3(p);
    hit.ng = Vec3(normalize(objectToRender_.normal(Vec3d(hit.ng))));
    Vec3 n = Vec3(normalize(objectToRender_.normal(Vec3d(hit.shading.z))));
    if (dot(n, hit.ng) < 0) n = -n;
    hit.shading = Frame::fromNormalTangent(n, Vec3(objectToRender_.vector(Vec3d(hit.shading.x))));
}

Bounds3 Instance::toRender(const Bounds3& b) const {
    Bounds3 result;
    if (b.empty()) return result;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p(corner & 1 ? b.upper.x : b.lower.x, corner & 2 ? b.upper.y : b.lower.y,
                      corner & 4 ? b.upper.z : b.lower.z);
        result.add(Vec3(objectToRender_.point(p)));
    }
    return result;
}

} // namespace abbe

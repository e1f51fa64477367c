#include "geometry/displacement.h"

#include <cmath>

namespace abbe {

namespace {

// A value with its derivatives by both parameters: forward-mode differentiation.
template <typename T> struct Dual {
    T x{}, u{}, v{};

    Dual operator+(const Dual& b) const { return {x + b.x, u + b.u, v + b.v}; }
    Dual operator-(const Dual& b) const { return {x - b.x, u - b.u, v - b.v}; }
};
using Scalar = Dual<double>;
using Vector = Dual<Vec3d>;

Vector operator*(const Vector& a, const Scalar& b) { return {a.x * b.x, a.u * b.x + a.x * b.u, a.v * b.x + a.x * b.v}; }
Vector operator*(const Vector& a, double b) { return {a.x * b, a.u * b, a.v * b}; }
Vector crossOf(const Vector& a, const Vector& b) {
    return {cross(a.x, b.x), cross(a.u, b.x) + cross(a.x, b.u), cross(a.v, b.x) + cross(a.x, b.v)};
}
// Requires a.x != 0.
Vector unit(const Vector& a) {
    const double s = 1 / length(a.x);
    const Vec3d n = a.x * s;
    return {n, (a.u - n * dot(n, a.u)) * s, (a.v - n * dot(n, a.v)) * s};
}

// The texture's channels as functions of the parameters, by the chain rule, less the midpoint and scaled.
struct Channels {
    Scalar c[3];
    Channels(const TextureJet& jet, const SurfaceJet& s, const Displacement& d) {
        for (int i = 0; i < d.channels(); ++i) {
            const auto along = [&](Vec3d p, Vec2d t) {
                double sum = jet.byUv[0][i] * t.x + jet.byUv[1][i] * t.y;
                for (std::size_t a = 0; a < 3; ++a) sum += jet.byPosition[a][i] * p[static_cast<int>(a)];
                return d.amount * sum;
            };
            c[i] = {d.amount * (jet.value[i] - d.midpoint), along(s.u, s.tu), along(s.v, s.tv)};
        }
    }
};

// ∂P/∂u of the texture coordinates but for a positive factor, and the sign of the map's orientation.
Vector textureTangent(const SurfaceJet& s, const Vector& du, const Vector& dv, double& sign) {
    const double det = s.tu.x * s.tv.y - s.tu.y * s.tv.x;
    const double size = std::hypot(s.tu.x, s.tu.y) * std::hypot(s.tv.x, s.tv.y);
    sign = det < 0 ? -1 : 1;
    if (!(std::abs(det) > 1e-6 * size)) return du; // no area in the texture: any tangent is as good
    const Scalar byU{s.tu.y, s.tuu.y, s.tuv.y}, byV{s.tv.y, s.tuv.y, s.tvv.y};
    return (du * byV - dv * byU) * sign;
}

} // namespace

std::optional<DisplacedPoint> displace(const SurfaceJet& s, const Displacement& d, Vec3d center, Vec2 home,
                                       double smallTangent) {
    const double lu = length(s.u), lv = length(s.v);
    if (!(lu > smallTangent) || !(lv > smallTangent)) return std::nullopt;
    const Vector p{s.p, s.u, s.v}, du{s.u, s.uu, s.uv}, dv{s.v, s.uv, s.vv};
    const Vector across = crossOf(du, dv);
    if (!(length(across.x) > 1e-5 * lu * lv)) return std::nullopt; // the sine of the angle between the tangents
    const Vector n = unit(across);
    const TextureJet value =
        d.map->jet({s.p + center, Vec2{static_cast<float>(s.t.x), static_cast<float>(s.t.y)}, home}, d.channels());
    const Channels h(value, s, d);
    Vector offset;
    if (d.space == Displacement::Space::normal) {
        offset = n * h.c[0];
    } else if (d.space == Displacement::Space::object) {
        offset = {{h.c[0].x, h.c[1].x, h.c[2].x}, {h.c[0].u, h.c[1].u, h.c[2].u}, {h.c[0].v, h.c[1].v, h.c[2].v}};
    } else {
        double sign = 1;
        const Vector t = unit(textureTangent(s, du, dv, sign));
        offset = t * h.c[0] + crossOf(n, t) * sign * h.c[1] + n * h.c[2];
    }
    DisplacedPoint result;
    const bool scalar = d.space == Displacement::Space::normal;
    result.direction = scalar ? n.x : offset.x;
    result.length = scalar ? h.c[0].x : 1;
    const Vector moved = p + offset;
    const Vec3d normal = cross(moved.u, moved.v);
    const double sine = length(normal) / (length(moved.u) * length(moved.v));
    if (!isFinite(result.direction * result.length)) return std::nullopt;
    if (sine > 1e-5) result.normal = normalize(normal);
    return result;
}

} // namespace abbe

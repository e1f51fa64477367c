#include "geometry/curves_surface.h"

namespace abbe {

namespace {

// The unit vector along v, or the other one if v is 0 against `scale`.
Vec3d unitOr(Vec3d v, double scale, Vec3d other) {
    const double l2 = lengthSquared(v);
    return l2 > 1e-24 * scale * scale && l2 > 0 ? v * (1 / std::sqrt(l2)) : other;
}

Vec3d perpendicular(Vec3d v, Vec3d axis) { return v - axis * dot(v, axis); }

Vec3d anyPerpendicular(Vec3d v) {
    const Vec3d other = std::abs(v.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    return normalize(cross(v, other));
}

// Towards the ray's origin, at a right angle to the curve.
Vec3d facing(Vec3d d, Vec3d tangent) { return unitOr(-perpendicular(d, tangent), 1, anyPerpendicular(tangent)); }

double acrossOf(Vec3d n, Vec3d d, Vec3d tangent) {
    const Vec3d side = unitOr(cross(tangent, -d), 1, Vec3d());
    return std::clamp(dot(n, side), -1.0, 1.0);
}

// Of the two meetings of the line with a cylinder about the curve at `c`, the one nearer to t.
double meetCylinder(Vec3d c, Vec3d tangent, double radius, Vec3d o, Vec3d d, double t) {
    const Vec3d w = perpendicular(o - c, tangent), e = perpendicular(d, tangent);
    const double a = lengthSquared(e);
    if (!(a > 1e-12)) return t; // along the curve
    const double middle = -dot(w, e) / a;
    const double half = safeSqrt((radius * radius - lengthSquared(w + e * middle)) / a);
    return t <= middle ? middle - half : middle + half;
}

} // namespace

// The surface is swept by circles at right angles to the curve. Both conditions, that the point lies in the circle's
// plane and on its rim, are met by turns: the first by moving u, the second by moving along the ray.
CurvePoint tubePoint(const CurveSegment& s, double u, Vec3d o, Vec3d d, double t) {
    Vec3d c, tangent, q;
    double radius = 0;
    constexpr int steps = 3;
    for (int i = 0;; ++i) {
        c = s.position(u);
        tangent = s.tangent(u).value_or(anyPerpendicular(d));
        radius = s.radius(u);
        t = meetCylinder(c, tangent, radius, o, d, t);
        q = o + d * t;
        if (i == steps) break;
        const double speed = length(s.derivative(u)), behind = dot(q - c, tangent);
        if (speed * 0.25 > std::abs(behind)) u = std::clamp(u + behind / speed, 0.0, 1.0);
    }
    const Vec3d out = unitOr(perpendicular(q - c, tangent), radius, facing(d, tangent));
    // With R the outward unit vector, S(u, R) = P + r R has the derivative T (|P'| - r R·T') + r' R along the tube, and
    // the normal is at a right angle to it. Where the tube is bent more sharply than it is thick the first factor turns
    // negative and the surface has folded over.
    const double speed = length(s.derivative(u));
    Vec3d n = out;
    if (speed > 0) {
        const Vec3d bend = perpendicular(s.secondDerivative(u), tangent) * (1 / speed);
        const double along = speed - radius * dot(out, bend), slope = s.radiusDerivative(u);
        if (along > 1e-6 * speed) n = unitOr(out * along - tangent * slope, std::abs(along) + std::abs(slope), out);
    }
    return {c + out * radius, n, tangent, u, acrossOf(out, d, tangent)};
}

CurvePoint conePoint(const SizedPoint& first, const SizedPoint& second, Vec3d o, Vec3d d, double t) {
    const Vec3d a(first.position), b(second.position);
    const auto ra = static_cast<double>(first.radius), rb = static_cast<double>(second.radius);
    const double l = length(b - a);
    const Vec3d axis = unitOr(b - a, 0, anyPerpendicular(d));
    // The normal of the cone leans by asin((ra - rb) / l) towards its thin end; if that has no solution one sphere
    // holds the other.
    const double sine = l > 0 ? (ra - rb) / l : 2;
    const bool nested = !(std::abs(sine) < 1);
    const double lean = nested ? 0 : sine / std::sqrt(1 - sine * sine);
    Vec3d c, n;
    double along = 0, radius = 0;
    constexpr int steps = 3;
    for (int i = 0;; ++i) {
        const Vec3d q = o + d * t, w = q - a;
        // The centre of the sphere whose surface is nearest to q.
        const double y = dot(w, axis), off = length(w - axis * y);
        along = nested ? (ra >= rb ? 0 : l) : std::clamp(y - off * lean, 0.0, l);
        c = a + axis * along;
        radius = l > 0 ? ra + (rb - ra) * (along / l) : std::max(ra, rb);
        n = unitOr(q - c, radius, facing(d, axis));
        const double approach = dot(n, d);
        // Newton's method on the signed distance; edge-on it would leave the neighbourhood.
        if (i == steps || std::abs(approach) < 1e-3) break;
        t -= (length(q - c) - radius) / approach;
    }
    return {c + n * radius, n, axis, l > 0 ? along / l : 0, acrossOf(n, d, axis)};
}

std::optional<Vec2d> meetCone(const SizedPoint& first, const SizedPoint& second, Vec3d o, Vec3d d) {
    const Vec3d a(first.position), b(second.position);
    const auto ra = static_cast<double>(first.radius), rb = static_cast<double>(second.radius);
    double enter = std::numeric_limits<double>::infinity(), leave = -enter;
    const auto add = [&](double t) {
        enter = std::min(enter, t);
        leave = std::max(leave, t);
    };
    const auto addSphere = [&](Vec3d c, double r) {
        const double middle = dot(c - o, d), h2 = r * r - lengthSquared(o + d * middle - c);
        if (!(h2 >= 0)) return;
        add(middle - std::sqrt(h2));
        add(middle + std::sqrt(h2));
    };
    addSphere(a, ra);
    addSphere(b, rb);
    const double l = length(b - a), sine = l > 0 ? (ra - rb) / l : 2;
    if (std::abs(sine) < 1) {
        // On the cone the normal makes a constant angle with the axis: n·(q - a) = ra. With y along the axis,
        // |q - a|² - y² = (ra - y sin)² / cos², a quadratic in t; from the middle of the ray for the sake of digits.
        const Vec3d axis = (b - a) * (1 / l);
        const double middle = dot((a + b) * 0.5 - o, d), m = 1 / (1 - sine * sine);
        const Vec3d w = o + d * middle - a;
        const double y0 = dot(w, axis), dy = dot(d, axis), k = ra - y0 * sine;
        const double qa = 1 - m * dy * dy, qb = dot(w, d) - y0 * dy + m * k * dy * sine;
        const double qc = lengthSquared(w) - y0 * y0 - m * k * k;
        const double root = std::sqrt(qb * qb - qa * qc); // NaN if the ray misses: refused below
        for (const double t : {(-qb - root) / qa, (-qb + root) / qa}) {
            const double y = y0 + t * dy, r = ra - y * sine, foot = y - r * m * sine;
            if (r > 0 && foot >= 0 && foot <= l) add(middle + t);
        }
    }
    if (!(enter <= leave)) return std::nullopt;
    return Vec2d{enter, leave};
}

namespace {

// Embree meets a row of flat quadrilaterals, whose u is off by their skew. The point meant is where the curve comes
// nearest to the ray's line, found by Newton's method on half the squared distance.
double nearestToLine(const CurveSegment& s, double u, Vec3d o, Vec3d d) {
    constexpr int steps = 4;
    for (int i = 0; i < steps; ++i) {
        const Vec3d off = perpendicular(s.position(u) - o, d), slope = perpendicular(s.derivative(u), d);
        const double bend = dot(off, s.secondDerivative(u)), gauss = lengthSquared(slope);
        const double step = dot(off, slope) / (gauss + bend > 0.5 * gauss ? gauss + bend : gauss);
        if (!(std::abs(step) < 0.25)) break; // along the ray: no better than what Embree says
        u = std::clamp(u - step, 0.0, 1.0);
    }
    return u;
}

} // namespace

CurvePoint ribbonPoint(const CurveSegment& s, double u, Vec3d o, Vec3d d) {
    u = nearestToLine(s, u, o, d);
    const Vec3d c = s.position(u);
    const Vec3d tangent = s.tangent(u).value_or(anyPerpendicular(d));
    const double radius = s.radius(u);
    const Vec3d p = o + d * dot(c - o, d);
    const Vec3d side = unitOr(cross(tangent, -d), 1, anyPerpendicular(tangent));
    const double across = radius > 0 ? std::clamp(dot(p - c, side) / radius, -1.0, 1.0) : 0;
    return {p, facing(d, tangent), tangent, u, across};
}

} // namespace abbe

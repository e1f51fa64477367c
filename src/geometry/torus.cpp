#include "geometry/torus.h"

#include "geometry/shape_params.h"

#include <array>
#include <cmath>
#include <utility>

namespace abbe {

namespace {

// Coefficients from the constant on.
template <int N> using Polynomial = std::array<double, N + 1>;

template <int N> double evaluate(const Polynomial<N>& c, double x) {
    double sum = c[N];
    for (int i = N - 1; i >= 0; --i) sum = std::fma(sum, x, c[static_cast<std::size_t>(i)]);
    return sum;
}

template <int N> Polynomial<N - 1> derivative(const Polynomial<N>& c) {
    Polynomial<N - 1> d{};
    for (int i = 1; i <= N; ++i) d[static_cast<std::size_t>(i - 1)] = i * c[static_cast<std::size_t>(i)];
    return d;
}

template <int N> struct PolynomialRoots {
    std::array<double, N> x{};
    int count = 0;
    void add(double root) { x[static_cast<std::size_t>(count++)] = root; }
};

// The root in [lower, upper], where c changes its sign once: Newton's method, and bisection where it would leave the
// bracket or does not halve it.
template <int N> double bracketedRoot(const Polynomial<N>& c, double lower, double upper) {
    const Polynomial<N - 1> slope = derivative<N>(c);
    const bool rising = evaluate<N>(c, upper) > 0;
    double x = 0.5 * (lower + upper), before = upper - lower, step = before;
    for (int i = 0; i < 100; ++i) {
        const double f = evaluate<N>(c, x), g = evaluate<N - 1>(slope, x);
        if (f == 0) return x;
        ((f > 0) == rising ? upper : lower) = x;
        const double newton = x - f / g;
        const bool good = newton > lower && newton < upper && std::abs(2 * f) <= std::abs(before * g);
        before = step;
        const double next = good ? newton : 0.5 * (lower + upper);
        step = next - x;
        if (next == x || std::abs(step) <= 0x1p-52 * std::abs(x)) return next;
        x = next;
    }
    return x;
}

// Roots in [lower, upper], ascending; a root where the sign does not change may be left out. Between neighbouring roots
// of the derivative there is at most one root, which a bracket holds and cannot lose [Yuksel2022].
template <int N> PolynomialRoots<N> rootsWithin(const Polynomial<N>& c, double lower, double upper) {
    PolynomialRoots<N> roots;
    if constexpr (N == 2) {
        const double b = 0.5 * c[1], discriminant = std::fma(b, b, -c[2] * c[0]);
        if (!(discriminant >= 0)) return roots;
        const double q = -(b + std::copysign(std::sqrt(discriminant), b));
        double first = q / c[2], second = q != 0 ? c[0] / q : first;
        if (first > second) std::swap(first, second);
        if (first >= lower && first <= upper) roots.add(first);
        if (second >= lower && second <= upper && second != first) roots.add(second);
    } else {
        const PolynomialRoots<N - 1> turns = rootsWithin<N - 1>(derivative<N>(c), lower, upper);
        double from = lower;
        bool below = evaluate<N>(c, from) < 0;
        for (int i = 0; i <= turns.count; ++i) {
            const double to = i < turns.count ? turns.x[static_cast<std::size_t>(i)] : upper;
            const bool belowNext = evaluate<N>(c, to) < 0;
            if (below != belowNext) roots.add(bracketedRoot<N>(c, from, to));
            from = to;
            below = belowNext;
        }
    }
    return roots;
}

} // namespace

namespace {

// Thinner tubes drown in the rounding of the quartic.
constexpr double kThinnestTube = 1e-5;

// The angle around the tube below which a share x of the area lies: θ + e sin θ = 2π x, for e = minor / major. That is
// Kepler's equation, seen from the far side of the orbit.
double tubeAngle(double x, double e) {
    const double target = 2 * kPiD * x;
    double lower = std::max(0.0, target - e), upper = std::min(2 * kPiD, target + e), angle = target;
    for (int i = 0; i < 60; ++i) {
        const double f = angle + e * std::sin(angle) - target;
        if (f == 0) break;
        (f > 0 ? upper : lower) = angle;
        double next = angle - f / (1 + e * std::cos(angle));
        if (!(next > lower && next < upper)) next = 0.5 * (lower + upper);
        if (std::abs(next - angle) < 1e-15) break;
        angle = next;
    }
    return angle;
}

} // namespace

Torus::Torus(double major, double minor, const Transform& toRender)
    : ParametricShape(toRender), major_(major), minor_(minor) {
    finish(circleBounds(0, major, minor), 4 * kPiD * kPiD * major * minor, areaUnderMap());
}

double Torus::areaUnderMap() const {
    const double own = 4 * kPiD * kPiD * major_ * minor_;
    if (const auto s = uniformStretch()) return *s * own;
    constexpr int steps = 256; // in each of two periods
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double tube = 2 * kPiD * (i + 0.5) / steps, weight = 1 + minor_ / major_ * std::cos(tube);
        for (int j = 0; j < steps; ++j) {
            const double phi = 2 * kPiD * (j + 0.5) / steps;
            sum += weight * stretch({std::cos(tube) * std::sin(phi), std::sin(tube), std::cos(tube) * std::cos(phi)});
        }
    }
    return own * sum / (steps * steps);
}

std::optional<ParametricShape::LocalHit> Torus::intersectLocal(Vec3d origin, Vec3d d, double tMax) const {
    // From the point of the line nearest to the centre the quartic has no cubic term, and its other coefficients do not
    // grow with the distance of the origin.
    const double shift = -dot(origin, d), outer2 = square(major_ + minor_) * (1 + 1e-9);
    const Vec3d o = origin + d * shift;
    const double m = lengthSquared(o);
    if (!(m <= outer2)) return std::nullopt;
    const double half = std::sqrt(outer2 - m);
    double from = std::max(-half, -shift), to = std::min(half, tMax - shift);
    if (d.y != 0) { // between the two planes that the tube touches
        const double r = minor_ * (1 + 1e-9), a = (-r - o.y) / d.y, b = (r - o.y) / d.y;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    } else if (std::abs(o.y) > minor_) {
        return std::nullopt;
    }
    if (!(from <= to)) return std::nullopt;
    // (|p|² + R² - r²)² = 4 R² (x² + z²) along o + s d. In units of R the coefficients are of order 1.
    const double scale = 1 / major_;
    const Vec3d c = o * scale;
    const double k = lengthSquared(c) + (1 - minor_ * scale) * (1 + minor_ * scale);
    const Polynomial<4> quartic{k * k - 4 * (c.x * c.x + c.z * c.z), -8 * (c.x * d.x + c.z * d.z),
                                2 * k - 4 * (d.x * d.x + d.z * d.z), 0, 1};
    const auto roots = rootsWithin<4>(quartic, from * scale, to * scale);
    for (int i = 0; i < roots.count; ++i) {
        const double t = roots.x[static_cast<std::size_t>(i)] * major_ + shift;
        if (t > 0 && t <= tMax) return LocalHit{t, 0};
    }
    return std::nullopt;
}

// The point at a longitude where the normal is (across, up) in the plane of the axis.
ParametricShape::LocalPoint Torus::at(double s, double c, double across, double up) const {
    const double r = major_ + minor_ * across;
    const double u = std::atan2(s, c) / (2 * kPiD), v = std::atan2(up, across) / (2 * kPiD);
    return {
        {r * s, minor_ * up, r * c}, {across * s, up, across * c}, {c, 0, -s}, {u < 0 ? u + 1 : u, v < 0 ? v + 1 : v}};
}

ParametricShape::LocalPoint Torus::project(Vec3d p, int) const {
    const double rho = std::hypot(p.x, p.z);
    const double across = rho - major_, l = std::hypot(across, p.y);
    const double s = rho > 0 ? p.x / rho : 0, c = rho > 0 ? p.z / rho : 1;
    return l > 0 ? at(s, c, across / l, p.y / l) : at(s, c, 1, 0);
}

ParametricShape::LocalDerivatives Torus::derivatives(const LocalPoint& at, int) const {
    const double s = -at.tangent.z, c = at.tangent.x, across = at.n.x * s + at.n.z * c;
    return {Vec3d(at.p.z, 0, -at.p.x) * (2 * kPiD), Vec3d(-at.n.y * s, across, -at.n.y * c) * (2 * kPiD * minor_)};
}

ParametricShape::LocalPoint Torus::sampleLocal(Vec2d u) const {
    const double tube = tubeAngle(u.x, minor_ / major_), longitude = 2 * kPiD * u.y;
    return at(std::sin(longitude), std::cos(longitude), std::cos(tube), std::sin(tube));
}

schema::TypeInfo torusType() {
    using namespace schema;
    using P = TorusParams;
    std::vector<FieldInfo> fields = {
        centerField<P>("Centre."),
        axisField<P>(),
        lengthField<P>("major-radius", &P::majorRadius, 1e-30, "0.5", "Radius of the circle that the tube follows.",
                       "major-radius 0.5 m", {"radius", "R"}),
        lengthField<P>("minor-radius", &P::minorRadius, 1e-30, "0.125", "Radius of the tube, at most the major radius.",
                       "minor-radius 0.1 m", {"tube-radius", "r"}),
    };
    addShapeFields<P>(fields);
    return {Kind::shape,
            "torus",
            "Exact torus: a ring with a round tube.",
            "shape torus { major-radius 0.5; minor-radius 0.1 }",
            false,
            std::move(fields)};
}

std::optional<UnplacedShape> makeTorus(const TorusParams& params, const ShapeContext& context) {
    const double major = params.majorRadius, minor = params.minorRadius;
    if (!checkAxis(params.axis, context)) return std::nullopt;
    if (!(minor <= major) || !(minor >= kThinnestTube * major)) {
        const bool thick = minor > major;
        context.diagnostics
            .error("E0613", context.span,
                   thick ? "the tube of a torus is wider than its ring, so that it crosses itself"
                         : "the tube of a torus is thinner than 1e-5 of its ring")
            .help = "`minor-radius` is at most `major-radius`, and at least 1e-5 of it";
        return std::nullopt;
    }
    const Transform upright = uprightAt(params.center, params.axis.value_or(context.up));
    UnplacedShape shape;
    shape.place = [major, minor, upright, context](const Transform& place) {
        return placeParametric(upright.then(place), context,
                               [&](const Transform& map) { return std::make_unique<Torus>(major, minor, map); });
    };
    return shape;
}

} // namespace abbe

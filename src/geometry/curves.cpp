#include "geometry/curves.h"

#include "base/check.h"
#include "geometry/surface_math.h"

#include <numeric>

namespace abbe {

namespace {

// kMonomial[basis][k][i]: weight of control point i in the coefficient of u^k.
using Matrix = std::array<std::array<double, 4>, 4>;
constexpr std::array<Matrix, 4> kMonomial{{
    {{{1, 0, 0, 0}, {-1, 1, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}},
    {{{1. / 6, 4. / 6, 1. / 6, 0}, {-0.5, 0, 0.5, 0}, {0.5, -1, 0.5, 0}, {-1. / 6, 0.5, -0.5, 1. / 6}}},
    {{{0, 1, 0, 0}, {-0.5, 0, 0.5, 0}, {1, -2.5, 2, -0.5}, {-0.5, 1.5, -1.5, 0.5}}},
    {{{1, 0, 0, 0}, {-3, 3, 0, 0}, {3, -6, 3, 0}, {-1, 3, -3, 1}}},
}};

template <typename T> std::array<T, 4> toBezier(const std::array<T, 4>& c) {
    return {c[0], c[0] + c[1] * (1. / 3), c[0] + c[1] * (2. / 3) + c[2] * (1. / 3), c[0] + c[1] + c[2] + c[3]};
}

} // namespace

CurveSegment::CurveSegment(CurveBasis basis, const SizedPoint* points) : c_{}, r_{} {
    const Matrix& m = kMonomial[static_cast<std::size_t>(basis)];
    const std::size_t count = basis == CurveBasis::linear ? 2 : 4;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d p(points[i].position);
        const auto r = static_cast<double>(points[i].radius);
        for (std::size_t k = 0; k < count; ++k) {
            c_[k] += p * m[k][i];
            r_[k] += r * m[k][i];
        }
    }
}

std::optional<Vec3d> CurveSegment::tangent(double u) const {
    const Vec3d d = derivative(u);
    const double l2 = lengthSquared(d);
    // Rounding of the coefficients leaves about 1e-16 of their size where the derivative is 0.
    const double scale = lengthSquared(c_[1]) + lengthSquared(c_[2]) + lengthSquared(c_[3]);
    if (l2 > 1e-20 * scale) return d * (1 / std::sqrt(l2));
    for (double h = 0x1p-12; h <= 1; h *= 2) {
        const Vec3d chord = position(std::min(u + h, 1.0)) - position(std::max(u - h, 0.0));
        const double chord2 = lengthSquared(chord);
        if (chord2 > 1e-24 * scale && chord2 > 0) return chord * (1 / std::sqrt(chord2));
    }
    return std::nullopt;
}

void CurveSegment::bezier(std::array<Vec3d, 4>& points, std::array<double, 4>& radii) const {
    points = toBezier(c_);
    radii = toBezier(r_);
}

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

std::optional<Vec2d> intersectCone(const SizedPoint& first, const SizedPoint& second, Vec3d o, Vec3d d) {
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

// Embree hits a row of flat quadrilaterals, whose u is off by their skew. The point meant is where the curve comes
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

namespace {

// Embree finds hits on tubes by iteration in float: its surface is off the exact one by some roundings of the
// coordinates and of the radius. Measured (tests/unit/geometry/curves_test.cpp).
constexpr float kIterationError = gammaBound(32);

bool visible(CurveBasis basis, const SizedPoint* p) {
    const std::uint32_t count = leastPoints(basis);
    bool wide = false, isLong = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        wide |= p[i].radius > 0;
        isLong |= p[i].position != p[0].position;
    }
    return wide && isLong;
}

} // namespace

Curves::Curves(CurveData data) : data_(std::move(data)) {
    const std::uint64_t total = std::accumulate(data_.strandSizes.begin(), data_.strandSizes.end(), std::uint64_t{0});
    ABBE_CHECK(total == data_.points.size() && total < 0xffffffffu && data_.later.size() < kMaxTimeSteps);
    for (const auto& step : data_.later) ABBE_CHECK(step.size() == total);
    strandFirst_.reserve(data_.strandSizes.size() + 1);
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < data_.strandSizes.size(); ++i) {
        addStrand(i, first, data_.strandSizes[i]);
        first += data_.strandSizes[i];
    }
    strandFirst_.push_back(first);
    data_.strandSizes = {}; // strandFirst_ says the same
    area_ = sumOfAreas();
}

void Curves::addStrand(std::uint32_t strand, std::uint32_t first, std::uint32_t size) {
    const std::uint32_t least = leastPoints(data_.basis), step = pointStep(data_.basis);
    ABBE_CHECK(size >= least && (size - least) % step == 0);
    strandFirst_.push_back(first);
    const bool joined = data_.basis == CurveBasis::linear && data_.form == CurveForm::round;
    bool previous = false;
    for (std::uint32_t i = first; i + least <= first + size; i += step) {
        const bool seen = isVisible(i);
        if (joined && seen && previous) neighbours_.back() |= kNextSegment;
        if (seen) {
            firstPoints_.push_back(i);
            strand_.push_back(strand);
            if (joined) neighbours_.push_back(previous ? kPreviousSegment : 0);
            addBounds(data_.points, i);
            for (const auto& later : data_.later) addBounds(later, i);
        } else {
            ++omitted_;
        }
        previous = seen;
    }
}

// What moves in straight lines stays in the hull of where it is at the steps.
void Curves::addBounds(const std::vector<SizedPoint>& step, std::uint32_t first) {
    std::array<Vec3d, 4> points;
    std::array<double, 4> radii;
    CurveSegment(data_.basis, &step[first]).bezier(points, radii);
    const double r = *std::max_element(radii.begin(), radii.end());
    for (Vec3d p : points) {
        const Vec3d margin = (abs(p) + Vec3d(r, r, r)) * 0x1p-22 + Vec3d(r, r, r);
        bounds_.add(Vec3(p - margin));
        bounds_.add(Vec3(p + margin));
    }
}

bool Curves::isVisible(std::uint32_t first) const {
    return visible(data_.basis, &data_.points[first]) ||
           std::ranges::any_of(data_.later, [&](const auto& step) { return visible(data_.basis, &step[first]); });
}

const SizedPoint* Curves::pointsAt(std::uint32_t first, std::uint32_t count, float time, SizedPoint* room) const {
    if (data_.later.empty()) [[likely]]
        return &data_.points[first];
    const StepPosition at = stepAt(time, data_.later.size() + 1);
    const auto& from = at.step == 0 ? data_.points : data_.later[at.step - 1];
    const auto& to = data_.later[at.step];
    for (std::uint32_t i = 0; i < count; ++i) room[i] = between(from[first + i], to[first + i], at.fraction);
    return room;
}

std::size_t Curves::bytes() const {
    return data_.points.size() * sizeof(SizedPoint) * (1 + data_.later.size()) + neighbours_.size() +
           (firstPoints_.size() + strand_.size() + strandFirst_.size()) * sizeof(std::uint32_t);
}

void Curves::commit(GeometrySink& sink) const {
    std::vector<std::span<const SizedPoint>> steps{data_.points};
    for (const auto& step : data_.later) steps.emplace_back(step);
    if (!firstPoints_.empty()) sink.curves(data_.basis, data_.form, steps, firstPoints_, neighbours_);
}

// Embree's arithmetic for round linear curves loses digits with the square of length / radius and more below a
// millimetre: it finds hits behind the ray's origin, and on ends that are buried in the next segment.
bool Curves::confirms(const RawHit& raw, const Ray& ray) const {
    const std::uint32_t first = firstPoints_[raw.primitive];
    std::array<SizedPoint, 4> room;
    const SizedPoint* p = pointsAt(first, 2, ray.time, room.data());
    const Vec3d o(ray.origin), direction(ray.direction);
    const double l = length(direction), reported = static_cast<double>(raw.distance) * l;
    const Vec3d d = direction * (1 / l);
    const auto cone = intersectCone(p[0], p[1], o, d);
    if (!cone) return false;
    const double t = reported - cone->x < cone->y - reported ? cone->x : cone->y;
    if (!(t > 0)) return false;
    const auto buried = [&](std::uint32_t neighbour) {
        const SizedPoint* q = pointsAt(neighbour, 2, ray.time, room.data());
        const double slack = 1e-6 * static_cast<double>(std::max(q[0].radius, q[1].radius));
        const auto inside = intersectCone(q[0], q[1], o, d);
        return inside && inside->x < t - slack && t + slack < inside->y;
    };
    const std::uint8_t neighbours = neighbours_[raw.primitive];
    return !((neighbours & kPreviousSegment) && buried(first - 1)) &&
           !((neighbours & kNextSegment) && buried(first + 1));
}

void Curves::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    std::array<SizedPoint, 4> room;
    const SizedPoint* points = pointsAt(firstPoints_[raw.primitive], leastPoints(data_.basis), ray.time, room.data());
    const Vec3d o(ray.origin), direction(ray.direction);
    const double l = length(direction), t = static_cast<double>(raw.distance) * l, u = static_cast<double>(raw.u);
    const Vec3d d = direction * (1 / l);
    const bool linear = data_.basis == CurveBasis::linear;
    const CurveSegment segment(data_.basis, points);
    const CurvePoint at = data_.form == CurveForm::flat ? ribbonPoint(segment, u, o, d)
                          : linear                      ? conePoint(points[0], points[1], o, d, t)
                                                        : tubePoint(segment, u, o, d, t);
    hit.p = Vec3(at.p);
    hit.ng = Vec3(at.normal);
    hit.shading = Frame::fromNormalTangent(hit.ng, Vec3(at.tangent));
    Vec3 magnitude;
    float radius = 0;
    for (std::uint32_t i = 0; i < leastPoints(data_.basis); ++i) {
        magnitude = max(magnitude, abs(points[i].position));
        radius = std::max(radius, points[i].radius);
    }
    hit.pError = (magnitude + Vec3(radius, radius, radius)) * kIterationError;

    const std::uint32_t strand = strand_[raw.primitive], step = pointStep(data_.basis);
    const std::uint32_t first = strandFirst_[strand], size = strandFirst_[strand + 1] - first;
    const double segments = (size - leastPoints(data_.basis)) / step + 1;
    const double before = (firstPoints_[raw.primitive] - first) / step;
    hit.uv = {static_cast<float>((before + at.u) / segments), static_cast<float>(0.5 + 0.5 * at.across)};
    hit.primitive = strand;
}

void Curves::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    std::array<SizedPoint, 4> room;
    const std::uint32_t needed = leastPoints(data_.basis), primitive = firstPoints_[raw.primitive];
    const CurveSegment segment(data_.basis, pointsAt(primitive, needed, ray.time, room.data()));
    const std::uint32_t strand = strand_[raw.primitive], first = strandFirst_[strand];
    const double segments = (strandFirst_[strand + 1] - first - needed) / pointStep(data_.basis) + 1;
    const double before = (primitive - first) / pointStep(data_.basis);
    const double u = std::clamp(static_cast<double>(hit.uv.x) * segments - before, 0.0, 1.0);
    // A tube is longer on the outside of its bends.
    Vec3d along = segment.derivative(u);
    const double speed = length(along);
    if (data_.form == CurveForm::round && speed > 0) {
        const Vec3d out = Vec3d(hit.p) - segment.position(u);
        const double bend = dot(out, segment.secondDerivative(u)) / (speed * speed), r = length(out);
        along = along * std::max(1 - bend, 0.0) + (r > 0 ? out * (segment.radiusDerivative(u) / r) : Vec3d());
    }
    const Vec3d side = cross(Vec3d(hit.shading.x), Vec3d(hit.ng));
    hit.dpdu = Vec3(along * segments);
    hit.dpdv = Vec3(side * (-2 * segment.radius(u)));
    if (data_.later.empty()) return;
    const Vec3d moved = CurveSegment(data_.basis, &data_.points[primitive]).position(u) - segment.position(u);
    hit.local = Vec3(Vec3d(hit.p) + moved);
}

// With the point of the axis that it lies around.
Vec3 Curves::carried(const RawHit& raw, const Ray& ray, const SurfaceHit& hit, float time) const {
    if (data_.later.empty()) return hit.p;
    const std::uint32_t needed = leastPoints(data_.basis), primitive = firstPoints_[raw.primitive];
    const std::uint32_t strand = strand_[raw.primitive], first = strandFirst_[strand];
    const double segments = (strandFirst_[strand + 1] - first - needed) / pointStep(data_.basis) + 1;
    const double before = (primitive - first) / pointStep(data_.basis);
    const double u = std::clamp(static_cast<double>(hit.uv.x) * segments - before, 0.0, 1.0);
    const auto axisAt = [&](float t) {
        std::array<SizedPoint, 4> room;
        return CurveSegment(data_.basis, pointsAt(primitive, needed, t, room.data())).position(u);
    };
    return Vec3(Vec3d(hit.p) + (axisAt(time) - axisAt(ray.time)));
}

double Curves::sumOfAreas() const {
    // Simpson's rule per quarter of a segment is far closer than anyone needs.
    double sum = 0;
    for (const std::uint32_t first : firstPoints_) {
        const CurveSegment s(data_.basis, &data_.points[first]);
        constexpr int n = 8;
        for (int i = 0; i <= n; ++i) {
            const double u = i / static_cast<double>(n), weight = i == 0 || i == n ? 1 : i % 2 ? 4 : 2;
            sum += weight / (3 * n) * s.radius(u) * std::hypot(length(s.derivative(u)), s.radiusDerivative(u));
        }
    }
    return sum * (data_.form == CurveForm::round ? 2 * kPiD : 2.0);
}

} // namespace abbe

#include "geometry/spherical_sampling.h"

#include "math/frame.h"
#include "math/warp.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <immintrin.h>

namespace abbe {

namespace {

// atan on [0, 1], absolute error below 2e-7: minimax polynomial in x², degree 17 in x.
inline __m128 atanUnit(__m128 x) {
    const __m128 z = _mm_mul_ps(x, x);
    __m128 r = _mm_set1_ps(0.0028662257f);
#pragma GCC unroll 8
    for (const float c :
         {-0.0161657367f, 0.0429096138f, -0.0752896400f, 0.1065626393f, -0.1420889944f, 0.1999355085f, -0.3333314528f})
        r = _mm_fmadd_ps(r, z, _mm_set1_ps(c));
    return _mm_fmadd_ps(_mm_mul_ps(r, z), x, x);
}

// The angles in [0, π] of (cosine, sine), sine >= 0, not both 0.
inline __m128 angles(__m128 cosine, __m128 sine) {
    const __m128 c = _mm_andnot_ps(_mm_set1_ps(-0.f), cosine);
    const __m128 a = atanUnit(_mm_div_ps(_mm_min_ps(c, sine), _mm_max_ps(c, sine)));
    const __m128 first = _mm_blendv_ps(a, _mm_sub_ps(_mm_set1_ps(kPi / 2), a), _mm_cmpgt_ps(sine, c));
    return _mm_blendv_ps(first, _mm_sub_ps(_mm_set1_ps(kPi), first), _mm_cmplt_ps(cosine, _mm_setzero_ps()));
}

// Sine and cosine of x in [-2π, 2π]: quarter turns are taken off in two steps, the second for the digits that π/2 as
// a float lacks.
inline SinCos sinCosTurn(float x) {
    const float turns = std::nearbyint(x * (2 / kPi));
    const float rest = std::fma(turns, 4.371139e-8f, std::fma(turns, -1.57079637f, x));
    const SinCos r = sinCosEighth(rest);
    // The quarter turns swap and negate; written without branches, which random angles would mispredict.
    const auto quarter = static_cast<std::uint32_t>(static_cast<std::int32_t>(turns));
    const std::array<float, 2> table{r.sin, r.cos};
    const auto negated = [](float v, std::uint32_t bit1) {
        return std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) ^ ((bit1 & 2) << 30));
    };
    return {negated(table[quarter & 1], quarter), negated(table[~quarter & 1], quarter + 1)};
}

} // namespace

SphericalRectangle::SphericalRectangle(float x0, float y0, float x1, float y1, float z)
    : x0_(x0), y0_(y0), x1_(x1), y1_(y1), z_(-std::abs(z)), k_(0), solidAngle_(0) {
    // Planes through the sides in turn: y = y0, x = x1, y = y1, x = x0. `cosine` has the z components of their unit
    // normals, `sine` is sqrt(1 - cosine²).
    const __m128 offset = _mm_setr_ps(-y0, x1, y1, -x0), height = _mm_set1_ps(z_), one = _mm_set1_ps(1);
    const __m128 inverse = _mm_div_ps(one, _mm_sqrt_ps(_mm_fmadd_ps(height, height, _mm_mul_ps(offset, offset))));
    const __m128 cosine = _mm_mul_ps(offset, inverse), sine = _mm_mul_ps(_mm_set1_ps(-z_), inverse);
    b0_ = cosine[0];
    b1_ = cosine[2];
    sine0_ = sine[0];
    if (!(z_ < 0)) return;
    const auto following = [](__m128 v) { return _mm_permute_ps(v, 0b00111001); };
    const __m128 a2 = _mm_mul_ps(sine, sine), b2 = following(a2);
    const __m128 both = _mm_sub_ps(_mm_add_ps(a2, b2), _mm_mul_ps(a2, b2));
    const __m128 gamma =
        angles(-_mm_mul_ps(cosine, following(cosine)), _mm_sqrt_ps(_mm_max_ps(both, _mm_setzero_ps())));
    k_ = 2 * kPi - gamma[2] - gamma[3];
    solidAngle_ = std::max(0.f, gamma[0] + gamma[1] - k_);
}

Vec2 SphericalRectangle::sample(Vec2 u) const {
    // [Urena2013], with both sides of the fraction under x multiplied by sin a, so that sin a = 0 is x = 0
    // and nothing is divided twice, and with 1 - c_u² as a product that does not cancel.
    const SinCos angle = sinCosTurn(std::fma(u.x, solidAngle_, k_));
    const float f = angle.cos * b0_ - b1_, s = sine0_ * angle.sin;
    const float along = std::sqrt(std::max(0.f, (f - s) * (f + s)));
    // along = 0 is x at infinity: the clamp settles it; 0 / 0 only occurs when the rectangle has no width.
    float x = std::copysign(z_, f) * angle.sin / along;
    if (!(x == x)) x = 0;
    x = std::clamp(x, x0_, x1_);
    const float d2 = std::fma(x, x, z_ * z_);
    const float h0 = y0_ / std::sqrt(std::fma(y0_, y0_, d2)), h1 = y1_ / std::sqrt(std::fma(y1_, y1_, d2));
    const float h = std::fma(u.y, h1 - h0, h0);
    const float y = h * std::sqrt(d2 / std::max(1e-30f, (1 - h) * (1 + h)));
    return {x, std::clamp(y, y0_, y1_)};
}

// The first coordinate is the share of the solid angle on this side of x.
Vec2 SphericalRectangle::inverse(Vec2 point) const {
    const SphericalRectangle before(x0_, y0_, point.x, y1_, z_);
    const float d2 = std::fma(point.x, point.x, z_ * z_);
    const auto height = [d2](float y) { return y / std::sqrt(std::fma(y, y, d2)); };
    const float h0 = height(y0_), h1 = height(y1_), h = height(point.y);
    return {std::clamp(before.solidAngle() / solidAngle_, 0.f, 1.f), std::clamp((h - h0) / (h1 - h0), 0.f, 1.f)};
}

namespace {

// The unit vector along the part of v that is at right angles to the unit vector n; 0 where there is none.
Vec3d across(Vec3d v, Vec3d n) {
    const Vec3d part = v - n * dot(v, n);
    const double l = length(part);
    return l > 0 ? part / l : Vec3d();
}

// Of unit vectors [VanOosterom1983], with the volume from differences of the corners: the sum of the angles less π
// would lose all digits of small triangles (docs/hard_cases.md, case 31).
double solidAngleOf(Vec3d a, Vec3d b, Vec3d c) {
    const double volume = std::abs(dot(a, cross(b - a, c - a)));
    return 2 * std::atan2(volume, 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

} // namespace

SphericalTriangle::SphericalTriangle(Vec3d a, Vec3d b, Vec3d c)
    : a_(normalize(a)), b_(normalize(b)), c_(normalize(c)), solidAngle_(solidAngleOf(a_, b_, c_)) {}

// A smaller triangle with the share u.x of the area, whose corner is C' on the side from a to c; then a point on the
// arc from b to C'.
Vec3d SphericalTriangle::direction(Vec2 u) const {
    const Vec3d n1 = cross(a_, b_), n2 = cross(a_, c_);
    const double alpha = std::atan2(length(cross(n1, n2)), dot(n1, n2));
    const double phi = static_cast<double>(u.x) * solidAngle_ - alpha;
    const double s = std::sin(phi), t = std::cos(phi), cosAlpha = std::cos(alpha), sinAlpha = std::sin(alpha);
    const double p = t - cosAlpha, q = s + sinAlpha * dot(a_, b_);
    const double below = (q * s + p * t) * sinAlpha;
    double cosine = below != 0 ? ((q * t - p * s) * cosAlpha - q) / below : 1;
    cosine = std::clamp(cosine, dot(a_, c_), 1.0); // between the corners
    const Vec3d corner = a_ * cosine + across(c_, a_) * safeSqrt(1 - cosine * cosine);
    const double z = 1 - static_cast<double>(u.y) * (1 - dot(corner, b_));
    return b_ * z + across(corner, b_) * safeSqrt(1 - z * z);
}

Vec2 SphericalTriangle::inverse(Vec3d w) const {
    Vec3d corner = cross(cross(b_, w), cross(c_, a_));
    const double l = length(corner);
    if (!(l > 0)) return {}; // at b, where all u.x meet
    corner = corner * ((dot(corner, a_ + c_) < 0 ? -1 : 1) / l);
    const double x = solidAngleOf(a_, b_, corner) / solidAngle_;
    const double y = lengthSquared(w - b_) / lengthSquared(corner - b_);
    return {static_cast<float>(std::clamp(x, 0.0, 1.0)), static_cast<float>(std::clamp(y, 0.0, 1.0))};
}

namespace {

// Below this ratio of the longest edge² to distance² directions are as good as uniform per area, which is cheaper.
constexpr double kNear = 0.15;
constexpr double kSmallest = 3e-4, kLargest = 6.22; // sr
// Least cosine of the angle between the halves of a quad.
constexpr double kFlat = 0.9;
// Some of what lies between a corner below the horizon and one above it is seen.
constexpr float kLeastShare = 0.01f;

bool isNear(std::span<const NearPolygon::Corners> triangles, Vec3d from) {
    double longest = 0, nearest = std::numeric_limits<double>::infinity();
    Vec3d middle;
    for (const auto& [a, b, c] : triangles) {
        longest = std::max({longest, lengthSquared(Vec3d(b) - Vec3d(a)), lengthSquared(Vec3d(c) - Vec3d(b)),
                            lengthSquared(Vec3d(a) - Vec3d(c))});
        for (const Vec3 p : {a, b, c}) nearest = std::min(nearest, lengthSquared(Vec3d(p) - from));
        middle += (Vec3d(a) + Vec3d(b) + Vec3d(c)) / (3.0 * static_cast<double>(triangles.size()));
    }
    return longest > kNear * lengthSquared(middle - from) && nearest > 1e-12 * longest;
}

} // namespace

std::optional<NearPolygon> NearPolygon::seen(std::span<const Corners> triangles, const Receiver& from) {
    std::optional<NearPolygon> polygon;
    if (!isNear(triangles, Vec3d(from.p))) return polygon;
    NearPolygon& n = polygon.emplace();
    n.from_ = Vec3d(from.p);
    n.byCosine_ = from.oneSided();
    double solidAngle = 0;
    for (const auto& [a, b, c] : triangles) {
        Half& h = n.halves_[n.count_++];
        h.a = Vec3d(a) - n.from_;
        h.s = Vec3d(b) - Vec3d(a);
        h.t = Vec3d(c) - Vec3d(a);
        h.view.emplace(h.a, h.a + h.s, h.a + h.t);
        solidAngle += h.view->solidAngle();
    }
    if (n.count_ > 1) {
        const Vec3d n0 = cross(n.halves_[0].s, n.halves_[0].t), n1 = cross(n.halves_[1].s, n.halves_[1].t);
        if (!(dot(n0, n1) > kFlat * length(n0) * length(n1)) && length(n0) * length(n1) > 0) polygon.reset();
    }
    if (!(solidAngle > kSmallest && solidAngle < kLargest)) polygon.reset();
    if (polygon) n.weigh(from);
    return polygon;
}

// The cosine of each corner of the square.
void NearPolygon::weigh(const Receiver& from) {
    float most = 0;
    for (int i = 0; byCosine_ && i < count_; ++i) {
        const Half& h = halves_[i];
        const auto cosine = [&from](Vec3d p) {
            return std::max(0.f, static_cast<float>(dot(p, Vec3d(from.n)) / length(p)));
        };
        const float b = cosine(h.a + h.s);
        halves_[i].cosine = {{b, b, cosine(h.a), cosine(h.a + h.t)}};
        for (const float c : h.cosine.corner) most = std::max(most, c);
    }
    if (byCosine_ && !(most > 0)) return;
    for (int i = 0; i < count_; ++i) {
        Half& h = halves_[i];
        if (byCosine_)
            for (float& c : h.cosine.corner) c = std::max(c, kLeastShare * most);
        h.mean = 0;
        for (const float c : h.cosine.corner) h.mean += 0.25 * static_cast<double>(c);
        // A half that is a line has no plane to sample.
        h.weight = lengthSquared(cross(h.s, h.t)) > 0 ? h.view->solidAngle() * h.mean : 0;
        weight_ += h.weight;
    }
}

std::optional<NearPolygon::Sample> NearPolygon::sample(Vec2 u) const {
    if (!(weight_ > 0)) return std::nullopt;
    const auto first = static_cast<float>(halves_[0].weight / weight_);
    const bool second = !(u.x < first);
    u.x = std::min(second ? (u.x - first) / (1 - first) : u.x / first, kOneMinusEpsilon);
    const Half& h = halves_[second];
    if (!(h.weight > 0)) return std::nullopt;
    if (byCosine_) u = h.cosine.sample(u);
    const double density = h.mean * (byCosine_ ? static_cast<double>(h.cosine.pdf(u)) : 1) / weight_;
    return Sample{second, weightsAlong(h, h.view->direction(u)), static_cast<float>(density)};
}

float NearPolygon::pdf(Vec3 p) const {
    if (!(weight_ > 0)) return 0;
    const Vec3d d = Vec3d(p) - from_;
    const Half& h = halfOf(d);
    if (!byCosine_) return static_cast<float>(h.mean / weight_);
    const float cosine = h.cosine.pdf(h.view->inverse(normalize(d)));
    return static_cast<float>(h.mean * static_cast<double>(cosine) / weight_);
}

// On which side of the edge that they share.
const NearPolygon::Half& NearPolygon::halfOf(Vec3d p) const {
    if (count_ == 1) return halves_[0];
    const auto& [h0, h1] = halves_;
    const Vec3d edge = h0.t - h0.s, normal = cross(h0.s, h0.t) + cross(h1.s, h1.t);
    return dot(cross(edge, p - (h0.a + h0.s)), normal) >= 0 ? h0 : h1;
}

// Where a direction meets the plane of a triangle.
Vec2 NearPolygon::weightsAlong(const Half& h, Vec3d w) {
    const Vec3d n = cross(h.s, h.t);
    const Vec3d hit = w * (dot(h.a, n) / dot(w, n)) - h.a;
    if (!isFinite(hit)) return {};
    const double n2 = dot(n, n);
    const double x = std::clamp(dot(cross(hit, h.t), n) / n2, 0.0, 1.0);
    const double y = std::clamp(dot(cross(h.s, hit), n) / n2, 0.0, 1.0 - x);
    return {static_cast<float>(x), static_cast<float>(y)};
}

namespace {

// ∫₀ʸ √(1 - t²/b²) dt.
double underEllipse(double y, double b) {
    const double s = std::clamp(y / b, -1.0, 1.0);
    return 0.5 * b * (s * std::sqrt(1 - s * s) + std::asin(s));
}

} // namespace

std::optional<ProjectedCap> ProjectedCap::seen(const Receiver& from, Vec3d axis, double d2, double r2) {
    constexpr double kSmallest = 0.01; // sine², 6°
    const double sin2 = r2 / d2;
    if (!from.oneSided() || !(sin2 > kSmallest)) return std::nullopt;
    ProjectedCap c;
    c.n_ = Vec3d(from.n);
    const double height = dot(axis, c.n_), sine = std::sqrt(sin2), cosine = std::sqrt(1 - sin2);
    if (!(height > -0.99 * sine)) return std::nullopt;
    const Vec3d side = axis - c.n_ * height;
    const double along = length(side);
    c.x_ = along > 1e-9 ? side / along : Vec3d(Frame::fromNormal(from.n).x);
    c.y_ = cross(c.n_, c.x_);
    c.centre_ = along * cosine;
    c.a_ = sine * height;
    c.b_ = sine;
    if (height >= sine) {
        c.solidAngle_ = kPiD * sin2 * height;
        return c;
    }
    c.tangent_ = safeSqrt(1 - (cosine / along) * (cosine / along));
    c.middleArea_ = c.middle(c.tangent_);
    c.solidAngle_ = 2 * (c.middleArea_ + (c.a_ > 0 ? c.wing(c.b_) : 0));
    return c.solidAngle_ > 0 ? std::optional(c) : std::nullopt;
}

// The area between the near side of the ellipse and the arc, from the x axis to y.
double ProjectedCap::middle(double y) const { return underEllipse(y, 1) - centre_ * y + a_ * underEllipse(y, b_); }

// The area within the ellipse from the tangent to y.
double ProjectedCap::wing(double y) const { return 2 * a_ * (underEllipse(y, b_) - underEllipse(tangent_, b_)); }

// The y up to which the half y > 0 has this area: Newton's method, kept in a bracket.
double ProjectedCap::inverse(double area) const {
    const bool inMiddle = area <= middleArea_ || !(a_ > 0);
    double low = inMiddle ? 0 : tangent_, high = inMiddle ? tangent_ : b_, y = 0.5 * (low + high);
    for (int i = 0; i < 60 && high - low > 1e-14; ++i) {
        const double excess = inMiddle ? middle(y) - area : middleArea_ + wing(y) - area;
        (excess > 0 ? high : low) = y;
        const double q = safeSqrt(1 - (y / b_) * (y / b_));
        const double width = inMiddle ? safeSqrt(1 - y * y) - centre_ + a_ * q : 2 * a_ * q;
        const double next = y - excess / width;
        if (std::abs(next - y) < 1e-13) break;
        y = next > low && next < high ? next : 0.5 * (low + high);
    }
    return y;
}

Vec2d ProjectedCap::place(Vec2 u) const {
    if (tangent_ == 0) {
        const Vec2 d = squareToDisk(u);
        return {centre_ + a_ * static_cast<double>(d.x), b_ * static_cast<double>(d.y)};
    }
    const double v = 2 * static_cast<double>(u.x) - 1;
    const double y = inverse(std::abs(v) * 0.5 * solidAngle_);
    const double near = a_ * safeSqrt(1 - (y / b_) * (y / b_));
    const double from = centre_ - near, to = y <= tangent_ ? safeSqrt(1 - y * y) : centre_ + near;
    return {std::lerp(from, to, static_cast<double>(u.y)), std::copysign(y, v)};
}

Vec3d ProjectedCap::direction(Vec2 u) const {
    const Vec2d p = place(u);
    return normalize(x_ * p.x + y_ * p.y + n_ * safeSqrt(1 - p.x * p.x - p.y * p.y));
}

double ProjectedCap::pdf(Vec3d w) const { return std::max(0.0, dot(w, n_)) / solidAngle_; }

} // namespace abbe

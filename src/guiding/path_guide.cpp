#include "guiding/path_guide.h"

#include "math/warp.h"

#include <algorithm>
#include <cmath>

namespace abbe {

// With s = |x| + |y| + |z| of a unit vector, w / s lies on a face of the octahedron, at the distance 1/s; seen along z
// the upper faces fill a square that stands on its corner, and dω = s³ dx dy.
SphereSquare SphereSquare::of(Vec3 w) {
    const float scale = 0.5f / (std::abs(w.x) + std::abs(w.y) + std::abs(w.z));
    const Vec2 u{0.5f + (w.x + w.y) * scale, 0.5f + (w.y - w.x) * scale};
    return {w.z >= 0, {std::clamp(u.x, 0.f, kOneMinusEpsilon), std::clamp(u.y, 0.f, kOneMinusEpsilon)}};
}

Vec3 SphereSquare::direction() const {
    const float x = u.x - u.y, y = u.x + u.y - 1;
    const float z = std::max(0.f, 1 - std::abs(x) - std::abs(y));
    return normalize(Vec3(x, y, upper ? z : -z));
}

float SphereSquare::areaPerSolidAngle(Vec3 w) {
    const float s = std::abs(w.x) + std::abs(w.y) + std::abs(w.z);
    return 0.5f / (s * s * s); // the square that stands on its corner has the area 2
}

Vec3 PathGuide::Region::offset(Vec3 p) const {
    constexpr float kFarthest = 0.8f;
    const Vec3 o = (p - centre) * nearness;
    const float r2 = dot(o, o);
    return r2 <= kFarthest * kFarthest ? o : o * (kFarthest / std::sqrt(r2));
}

// Where w reaches the sphere about p is w + o seen from the centre, and dω' = (w · w') / |w + o|² dω.
PathGuide::Seen PathGuide::Region::seen(Vec3 p, Vec3 w) const {
    if (!(nearness > 0)) return {w, 1};
    const Vec3 v = w + offset(p);
    const float r2 = dot(v, v), r = std::sqrt(r2);
    return {v / r, dot(w, v) / (r2 * r)};
}

namespace {

float widened(std::uint16_t upperHalf) { return std::bit_cast<float>(static_cast<std::uint32_t>(upperHalf) << 16); }

} // namespace

PathGuide::Direction PathGuide::look(const Region& region, const Square* first, Vec3 p, Vec3 direction) {
    const auto [w, stretch] = region.seen(p, direction);
    const SphereSquare at = SphereSquare::of(w);
    const Square* square = first + (at.upper ? region.upperRoot : 0);
    float x = 4 * at.u.x, y = 4 * at.u.y; // in parts of the square
    for (;;) {
        const int column = static_cast<int>(x), row = static_cast<int>(y);
        const Square::Part& part = square->parts[static_cast<std::size_t>(4 * row + column)];
        if (part.child == 0) {
            const float density = (at.upper ? region.upper : 1 - region.upper) * part.density;
            return {direction, stretch * density * SphereSquare::areaPerSolidAngle(w), widened(part.radiance)};
        }
        x = 4 * (x - static_cast<float>(column));
        y = 4 * (y - static_cast<float>(row));
        square = first + part.child;
    }
}

namespace {

// Which of four, whose shares add up to those given; u is spread over [0, 1) again.
std::size_t chooses(float& u, const std::array<float, 3>& sums) {
    const std::size_t i = static_cast<std::size_t>((u >= sums[0]) + (u >= sums[1]) + (u >= sums[2]));
    const float first = i == 0 ? 0 : sums[i - 1], last = i == 3 ? 1 : sums[i];
    u = std::clamp((u - first) / (last - first), 0.f, kOneMinusEpsilon);
    return i;
}

} // namespace

PathGuide::Direction PathGuide::sample(const Region& region, Vec3 p, Vec2 u) const {
    const bool upper = u.x < region.upper;
    const float half = upper ? region.upper : 1 - region.upper;
    u.x = std::min((upper ? u.x : u.x - region.upper) / half, kOneMinusEpsilon);
    std::size_t square = region.first + (upper ? region.upperRoot : 0u);
    Vec2 corner;
    for (float size = 0.25f;; size *= 0.25f) {
        const Sums& sums = sums_[square];
        const std::size_t column = chooses(u.x, sums.columns), row = chooses(u.y, sums.rows[column]);
        corner = corner + Vec2{static_cast<float>(column), static_cast<float>(row)} * size;
        const Square::Part& part = squares_[square].parts[4 * row + column];
        if (part.child == 0) {
            const Vec2 place = corner + u * size;
            const SphereSquare at{upper, {std::min(place.x, kOneMinusEpsilon), std::min(place.y, kOneMinusEpsilon)}};
            const Vec3 w = at.direction();
            const float pdf = half * part.density * SphereSquare::areaPerSolidAngle(w);
            if (!(region.nearness > 0)) return {w, pdf, widened(part.radiance)};
            const Vec3 o = region.offset(p);
            const float b = dot(w, o), r = b + std::sqrt(b * b + 1 - dot(o, o));
            const Vec3 direction = normalize(w * r - o);
            return {direction, pdf * dot(direction, w) / (r * r), widened(part.radiance)};
        }
        square = region.first + part.child;
    }
}

std::size_t PathGuide::bytes() const {
    return space_.bytes() + regions_.size() * sizeof(Region) + squares_.size() * (sizeof(Square) + sizeof(Sums));
}

} // namespace abbe

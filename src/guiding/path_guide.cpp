#include "guiding/path_guide.h"

#include "math/warp.h"

#include <algorithm>
#include <cmath>

namespace abbe {

Vec3 SphereSquare::direction() const {
    const float x = u.x - u.y, y = u.x + u.y - 1;
    const float z = std::max(0.f, 1 - std::abs(x) - std::abs(y));
    return normalize(Vec3(x, y, upper ? z : -z));
}

namespace {

float sumOfAbs(Vec3 v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

float widened(std::uint16_t upperHalf) { return std::bit_cast<float>(static_cast<std::uint32_t>(upperHalf) << 16); }

} // namespace

Vec3 PathGuide::Region::offset(Vec3 p) const {
    constexpr float kFarthest = 0.8f;
    const Vec3 o = (p - centre) * nearness;
    const float r2 = dot(o, o);
    return r2 <= kFarthest * kFarthest ? o : o * (kFarthest / std::sqrt(r2));
}

// Where w reaches the sphere about the place is v = w + offset seen from the centre, and the solid angles there are
// (w · v) / |v|³ times those from the place. The square has 1/2 (|v| / s)³ for each of them, of which |v| cancels.
PathGuide::Seen PathGuide::seen(Vec3 offset, Vec3 w) {
    const Vec3 v = w + offset;
    const float inverse = 1 / sumOfAbs(v);
    return {SphereSquare::of(v, inverse), 0.5f * dot(w, v) * inverse * inverse * inverse};
}

PathGuide::Direction PathGuide::look(const Region& region, const Square* first, Vec3 offset, Vec3 w) {
    const auto [at, area] = seen(offset, w);
    const Square* square = first + (at.upper ? region.upperRoot : 0);
    float x = 4 * at.u.x, y = 4 * at.u.y; // in parts of the square
    for (;;) {
        const int column = static_cast<int>(x), row = static_cast<int>(y);
        const Square::Part& part = square->parts[static_cast<std::size_t>(4 * row + column)];
        if (part.child == 0) {
            const float density = (at.upper ? region.upper : 1 - region.upper) * part.density;
            return {w, density * area, widened(part.radiance)};
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

PathGuide::Direction PathGuide::sample(const Region& region, Vec3 offset, Vec2 u) const {
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
            // From the centre of the region to the sphere about the place.
            const Vec3 fromCentre = at.direction();
            const float b = dot(fromCentre, offset), r = b + std::sqrt(b * b + 1 - dot(offset, offset));
            const Vec3 w = normalize(fromCentre * r - offset);
            return {w, half * part.density * seen(offset, w).area, widened(part.radiance)};
        }
        square = region.first + part.child;
    }
}

std::size_t PathGuide::bytes() const {
    return space_.bytes() + regions_.size() * sizeof(Region) + squares_.size() * (sizeof(Square) + sizeof(Sums));
}

} // namespace abbe

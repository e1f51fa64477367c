#include "guiding/path_guide.h"

#include "math/warp.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <immintrin.h>

namespace abbe {

Vec3 SphereSquare::onOctahedron() const {
    const float x = u.x - u.y, y = u.x + u.y - 1;
    const float z = std::max(0.f, 1 - std::abs(x) - std::abs(y));
    return {x, y, upper ? z : -z};
}

namespace {

float widened(std::uint16_t upperHalf) { return std::bit_cast<float>(static_cast<std::uint32_t>(upperHalf) << 16); }

} // namespace

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

// One of four, in proportion to their masses, drawn by u in [0, 1), which is spread over [0, 1) again.
std::uint32_t choose(__m128 masses, float& u) {
    const auto fromOne = _mm_castsi128_ps(_mm_slli_si128(_mm_castps_si128(masses), 4));
    const __m128 pairs = _mm_add_ps(masses, fromOne);
    const __m128 sums = _mm_add_ps(pairs, _mm_castsi128_ps(_mm_slli_si128(_mm_castps_si128(pairs), 8)));
    std::array<float, 5> upTo{};
    _mm_storeu_ps(upTo.data() + 1, sums);
    const float x = u * upTo[4];
    const int passed = _mm_movemask_ps(_mm_cmpge_ps(_mm_set1_ps(x), sums)) & 0b111;
    const auto i = static_cast<std::uint32_t>(std::popcount(static_cast<unsigned>(passed)));
    u = std::clamp((x - upTo[i]) / (upTo[i + 1] - upTo[i]), 0.f, kOneMinusEpsilon);
    return i;
}

// Of parts that follow each other.
__m128 densitiesOf(const PathGuide::Square::Part* parts) {
    const auto two = [](const PathGuide::Square::Part* p) { return _mm_loadu_ps(&p->density); };
    return _mm_shuffle_ps(two(parts), two(parts + 2), 0b10'00'10'00);
}

// Which part a direction falls in: a column of the square, and a row of that.
std::uint32_t choosePart(const PathGuide::Square& square, Vec2& u) {
    const auto& p = square.parts;
    const __m128 columns = _mm_add_ps(_mm_add_ps(densitiesOf(&p[0]), densitiesOf(&p[4])),
                                      _mm_add_ps(densitiesOf(&p[8]), densitiesOf(&p[12])));
    const std::uint32_t c = choose(columns, u.x);
    const __m128 rows = _mm_setr_ps(p[c].density, p[4 + c].density, p[8 + c].density, p[12 + c].density);
    return 4 * choose(rows, u.y) + c;
}

} // namespace

PathGuide::Direction PathGuide::sample(const Region& region, Vec3 offset, Vec2 u) const {
    const bool upper = u.x < region.upper;
    const float half = upper ? region.upper : 1 - region.upper;
    u.x = std::min((upper ? u.x : u.x - region.upper) / half, kOneMinusEpsilon);
    std::size_t square = region.first + (upper ? region.upperRoot : 0u);
    Vec2 corner;
    for (float size = 0.25f;; size *= 0.25f) {
        const std::uint32_t chosen = choosePart(squares_[square], u);
        corner = corner + Vec2{static_cast<float>(chosen % 4), static_cast<float>(chosen / 4)} * size;
        const Square::Part& part = squares_[square].parts[chosen];
        if (part.child == 0) {
            const Vec2 place = corner + u * size;
            const SphereSquare at{upper, {std::min(place.x, kOneMinusEpsilon), std::min(place.y, kOneMinusEpsilon)}};
            // The sphere about the place is k v away from the centre of the region: |k v - offset| = 1.
            const Vec3 v = at.onOctahedron();
            const float v2 = dot(v, v), b = dot(v, offset);
            const float k = (b + std::sqrt(b * b + v2 * (1 - dot(offset, offset)))) / v2;
            Vec3 w = v * k - offset;
            w = w * (1.5f - 0.5f * dot(w, w)); // of unit length but for rounding, whose square is left
            // As seen() has it, where |x| + |y| + |z| is k.
            return {w, half * part.density * 0.5f * dot(w, v) / (k * k), widened(part.radiance)};
        }
        square = region.first + part.child;
    }
}

std::size_t PathGuide::bytes() const {
    return space_.bytes() + regions_.size() * sizeof(Region) + squares_.size() * sizeof(Square) +
           (cache_ ? cache_->bytes() : 0);
}

} // namespace abbe

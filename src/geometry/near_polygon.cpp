#include "geometry/near_polygon.h"

#include <algorithm>
#include <cmath>

namespace abbe {

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

} // namespace abbe

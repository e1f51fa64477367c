#include "materials/sheen_lobe.h"

#include "math/warp.h"

#include <cmath>

namespace abbe {
namespace {

#include "materials/data/sheen_table.inl"

// Cosine and sine of wo's azimuth; any for wo upright.
Vec2 azimuth(Vec3 wo) {
    const float r2 = wo.x * wo.x + wo.y * wo.y;
    if (!(r2 > 1e-30f)) return {1, 0};
    const float scale = 1 / std::sqrt(r2);
    return {wo.x * scale, wo.y * scale};
}

SheenLobe::Entry mix(const SheenLobe::Entry& p, const SheenLobe::Entry& q, float t) {
    return {p.albedo + (q.albedo - p.albedo) * t, p.a + (q.a - p.a) * t, p.b + (q.b - p.b) * t};
}

} // namespace

SheenLobe::SheenLobe(float roughness) {
    const float row = std::clamp(roughness, 0.f, 1.f) * (kRoughnesses - 1);
    row_ = std::min(static_cast<int>(row), kRoughnesses - 2);
    rowShare_ = row - static_cast<float>(row_);
}

SheenLobe::Entry SheenLobe::at(float cosine) const {
    const float column = std::sqrt(std::clamp(cosine, 0.f, 1.f)) * (kCosines - 1);
    const int i = std::min(static_cast<int>(column), kCosines - 2);
    const float t = column - static_cast<float>(i);
    const auto& lower = kSheenTable[row_];
    const auto& upper = kSheenTable[row_ + 1];
    return mix(mix(lower[i], lower[i + 1], t), mix(upper[i], upper[i + 1], t), rowShare_);
}

// The density of M^-1 w on Lambert's lobe, times |M^-1| / |M^-1 w|³ for the change of solid angle [Heitz2016, eq. 1].
SheenLobe::Value SheenLobe::eval(Vec3 wo, Vec3 wi) const {
    if (!(wi.z > 0)) return {};
    const Entry e = at(wo.z);
    const Vec2 c = azimuth(wo);
    const float x = e.a * (c.x * wi.x + c.y * wi.y) + e.b * wi.z, y = e.a * (c.x * wi.y - c.y * wi.x);
    const float length2 = x * x + y * y + wi.z * wi.z;
    const float pdf = wi.z * e.a * e.a / (kPi * length2 * length2);
    return {e.albedo * pdf, pdf};
}

Vec3 SheenLobe::sample(Vec3 wo, Vec2 u) const {
    const Entry e = at(wo.z);
    const Vec2 c = azimuth(wo);
    const Vec3 w = squareToCosineHemisphere(u);
    const float x = (w.x - e.b * w.z) / e.a, y = w.y / e.a;
    return normalize(Vec3{c.x * x - c.y * y, c.y * x + c.x * y, w.z});
}

} // namespace abbe

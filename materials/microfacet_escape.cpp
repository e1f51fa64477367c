#include "materials/microfacet_escape.h"

namespace abbe {
namespace {

// Gauss's points and weights on [0, 1].
constexpr int kPoints = 6;
constexpr float kPoint[kPoints] = {0.0337652429f, 0.1693953068f, 0.3806904070f,
                                   0.6193095930f, 0.8306046932f, 0.9662347571f};
constexpr float kWeight[kPoints] = {0.0856622462f, 0.1803807865f, 0.2339569673f,
                                    0.2339569673f, 0.1803807865f, 0.0856622462f};

constexpr Spectrum kTiny(1e-12f);

} // namespace

MicrofacetEscape::MicrofacetEscape(const Ggx& ggx, Vec3 wo, Spectrum eta)
    : wo_(wo), up_{1, 0, 0}, side_{0, 1, 0}, sine_(std::sqrt(wo.x * wo.x + wo.y * wo.y)), stretch_(ggx.stretch(wo)),
      alphaX2_(square(ggx.alphaX())), alphaY2_(square(ggx.alphaY())), round_(ggx.alphaX() == ggx.alphaY()), eta_(eta) {
    float alpha2 = 0.5f * (alphaX2_ + alphaY2_);
    if (sine_ > 0) {
        const float x = wo.x / sine_, y = wo.y / sine_;
        up_ = {-x * wo.z, -y * wo.z, sine_};
        side_ = {-y, x, 0};
        alpha2 = alphaX2_ * x * x + alphaY2_ * y * y;
    }
    narrow_ = 1 - std::min(alpha2, 1.f);
    perCircle_ = (round_ ? 4 : 2) * ggx.visible(wo) / (kPi * ggx.alphaX() * ggx.alphaY());
}

Spectrum MicrofacetEscape::kept(const Direction& wi) const {
    const Spectrum stretch = sqrt(fma(wi.x * alphaX2_, wi.x, fma(wi.y * alphaY2_, wi.y, wi.z * wi.z)));
    const Spectrum share = wi.z * (wo_.z + stretch_) / max(wi.z * stretch_ + stretch * wo_.z, kTiny);
    return select(wi.z.v > 0.f, share, kNone);
}

Spectrum MicrofacetEscape::density(const Direction& m) const {
    const Spectrum slope2 = fma(m.x * (1 / alphaX2_), m.x, fma(m.y * (1 / alphaY2_), m.y, m.z * m.z));
    return kOne / (slope2 * slope2);
}

// The circle by t = tan(φ/2), φ from the microfacet nearest to the normal: from 0 to where the microfacet stands
// upright, or to infinity. t = w p/(1 - κ p) puts half of the p in [0, 1] where the normals are dense, at t < w.
MicrofacetEscape::Shares MicrofacetEscape::operator()(Spectrum c) const {
    const Spectrum s = sqrt(max((kOne - c) * (kOne + c), kNone));
    const Spectrum a = wo_.z * c, b = max(sine_ * s, kTiny), top = a + b;
    const Spectrum bend = max((kOne - narrow_ * top * top) / max(narrow_ * top * b, kTiny), Spectrum(1e-6f));
    const Spectrum w = min(0.7f * sqrt(bend), kOne);
    const Spectrum kappa = kOne - w * sqrt(max(b - a, kNone) / top);
    const Spectrum g2 = (eta_ - kOne) * (eta_ + kOne) + c * c, turn = c - sqrt(max(g2, kNone));
    const Spectrum x(wo_.x), y(wo_.y), z(wo_.z), twice = c + c;
    const int panels = round_ ? 2 : 4; // light that just leaves, and normals that crowd, make kinks
    Shares sum{kNone, kNone};
    for (int i = 0; i < kPoints * panels; ++i) {
        const float p = (kPoint[i % kPoints] + static_cast<float>(i / kPoints)) / static_cast<float>(panels);
        const Spectrum rest = kOne / (kOne - kappa * p), t = w * p * rest, per = kOne / fma(t, t, kOne);
        const Spectrum arc = kWeight[i % kPoints] * w * rest * rest * per;
        for (int sign = round_ ? 1 : -1; sign <= 1; sign += 2) {
            const Spectrum u = s * (kOne - t * t) * per, v = s * t * per * static_cast<float>(2 * sign);
            const Direction m{fma(c, x, u * up_.x + v * side_.x), fma(c, y, u * up_.y + v * side_.y),
                              max(fma(c, z, u * up_.z), kNone)};
            const Direction back{m.x * twice - x, m.y * twice - y, m.z * twice - z};
            const Direction through{(m.x * turn - x) / eta_, (m.y * turn - y) / eta_, (z - m.z * turn) / eta_};
            const Spectrum met = arc * density(m);
            sum.reflected += met * kept(back);
            sum.refracted += met * kept(through);
        }
    }
    const Spectrum per = select(g2.v > 0.f, c * (perCircle_ / static_cast<float>(panels)), kNone);
    return {sum.reflected * per, sum.refracted * per};
}

} // namespace abbe

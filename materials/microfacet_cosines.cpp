#include "materials/microfacet_cosines.h"

#include "materials/ggx.h"

#include <cstdint>

namespace abbe {
namespace {

#include "materials/data/microfacet_cosines.inl"

using CosineGrid = MicrofacetCosineGrid;

Spectrum node(const std::int16_t* table, int roughness, int mu) {
    const std::int16_t* row = table + (roughness * CosineGrid::kMu + mu) * 8;
    const __m128i packed = _mm_loadu_si128(reinterpret_cast<const __m128i*>(row));
    return Spectrum(_mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(packed)));
}

Spectrum between(Spectrum a, Spectrum b, float t) { return fma(b - a, Spectrum(t), a); }

// The cell of a position in [0, 1] among `count` nodes; `position` becomes the place within the cell.
int cellOf(float& position, int count) {
    const float scaled = std::clamp(position, 0.f, 1.f) * static_cast<float>(count - 1);
    const int cell = std::min(static_cast<int>(scaled), count - 2);
    position = scaled - static_cast<float>(cell);
    return cell;
}

Spectrum lookUp(const std::int16_t* table, float mu, float alpha) {
    const float width = std::max(alpha, static_cast<float>(GgxAlbedoGrid::kMinAlpha));
    float x = GgxAlbedoGrid::coordinate(mu, width, 0.f), y = std::sqrt(std::min(alpha, 1.f));
    const int i = cellOf(x, CosineGrid::kMu), j = cellOf(y, CosineGrid::kRoughness);
    const Spectrum low = between(node(table, j, i), node(table, j, i + 1), x);
    const Spectrum high = between(node(table, j + 1, i), node(table, j + 1, i + 1), x);
    const Spectrum scale(width * static_cast<float>(1 / CosineGrid::kScale));
    return min(max(fma(between(low, high, y), scale, Spectrum(mu)), Spectrum(0.f)), Spectrum(1.f));
}

} // namespace

Spectrum microfacetCosines(float mu, float alpha) { return lookUp(kMicrofacetCosines, mu, alpha); }

namespace {

// Half of the width between the inner points of a narrow lobe, in units of its spread: 0.6, and less of wide ones,
// whose own are known.
constexpr float kInnerHalf = 0.5f;

} // namespace

MetCosines::MetCosines(Spectrum lobe, float spread, float from, Kinks kinks, bool fine)
    : middle_(0.5f * (lobe[3] + lobe[4])), width_(std::max({0.5f * (lobe[5] - lobe[2]), kInnerHalf * spread, 1e-5f})) {
    std::ranges::sort(kinks);
    const auto intervals = 1 + std::ranges::count_if(kinks, [&](float k) { return k > from; });
    const int blocks = intervals == 1 ? (fine ? 4 : 2) : intervals == 2 ? 4 : 2;
    bool critical = from > 0;
    for (const float kink : kinks) {
        if (!(kink > from)) continue;
        addInterval(from, kink, critical, blocks);
        from = kink;
        critical = true;
    }
    addInterval(from, 1, critical, blocks);
}

// By the arsinh of the distance from the lobe's middle in units of its width.
void MetCosines::addInterval(float from, float to, bool critical, int blocks) {
    const float start = std::asinh((from - middle_) / width_), all = std::asinh((to - middle_) / width_) - start;
    const float panel = 1 / static_cast<float>(blocks);
    const Spectrum one(1.f);
    for (int i = 0; i < blocks; ++i, ++count_) {
        const Spectrum t = (Spectrum(kCosinePoints) + Spectrum(static_cast<float>(i))) * panel;
        const Spectrum place = critical ? t * t : t, pace = critical ? t + t : one;
        const Spectrum up = exp(fma(place, Spectrum(all), Spectrum(start))), down = one / up;
        cosines_[count_] =
            min(max(fma(up - down, Spectrum(0.5f * width_), Spectrum(middle_)), Spectrum(from)), Spectrum(to));
        steps_[count_] = (up + down) * pace * Spectrum(kCosineWeights) * (0.5f * width_ * all * panel);
    }
}

namespace {

// Gauss's points and weights on [0, 1].
constexpr int kQuadraturePoints = 6;
constexpr float kPoint[kQuadraturePoints] = {0.0337652429f, 0.1693953068f, 0.3806904070f,
                                             0.6193095930f, 0.8306046932f, 0.9662347571f};
constexpr float kWeight[kQuadraturePoints] = {0.0856622462f, 0.1803807865f, 0.2339569673f,
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
    for (int i = 0; i < kQuadraturePoints * panels; ++i) {
        const float p =
            (kPoint[i % kQuadraturePoints] + static_cast<float>(i / kQuadraturePoints)) / static_cast<float>(panels);
        const Spectrum rest = kOne / (kOne - kappa * p), t = w * p * rest, per = kOne / fma(t, t, kOne);
        const Spectrum arc = kWeight[i % kQuadraturePoints] * w * rest * rest * per;
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

#include "materials/gloss.h"

#include "materials/fresnel.h"
#include "materials/ggx_albedo.h"

#include <cmath>

namespace abbe {

Gloss::Gloss(double ior, float roughness)
    : ior_(static_cast<float>(ior)), ggx_(Ggx::fromRoughness(roughness, 0)), absent_(std::abs(ior_ - 1) < 1e-6f) {
    if (absent_) return;
    constexpr int kSide = 48; // points in each dimension of the sampler's square: error below 1e-4
    if (!smooth())
        for (int i = 0; i < kNodes; ++i) {
            const double root = std::max(i, 1) / (kNodes - 1.0), mu = root * root;
            const Vec3 wo(Vec3d{std::sqrt((1 - mu) * (1 + mu)), 0, mu});
            double sum = 0;
            for (int k = 0; k < kSide * kSide; ++k) {
                const Vec2 u{(static_cast<float>(k % kSide) + 0.5f) / kSide,
                             (static_cast<float>(k / kSide) + 0.5f) / kSide};
                if (const auto wi = sample(wo, u)) sum += static_cast<double>(weight(wo, *wi));
            }
            albedo_[static_cast<std::size_t>(i)] = static_cast<float>(sum / (kSide * kSide));
        }
    constexpr int kCosines = 1000;
    double mean = 0;
    for (int i = 0; i < kCosines; ++i) {
        const float mu = (static_cast<float>(i) + 0.5f) / kCosines;
        mean += static_cast<double>(2 * mu * albedo(mu)) / kCosines;
    }
    meanAlbedo_ = static_cast<float>(mean);
}

float Gloss::albedo(float mu) const {
    if (absent_) return 0;
    if (smooth()) return fresnelDielectric(std::min(mu, 1.f), ior_);
    const float x = std::sqrt(std::clamp(mu, 0.f, 1.f)) * (kNodes - 1);
    const int i = std::min(static_cast<int>(x), kNodes - 2);
    const auto at = [this](int k) { return albedo_[static_cast<std::size_t>(k)]; };
    return at(i) + (at(i + 1) - at(i)) * (x - static_cast<float>(i));
}

float Gloss::lossless(float mu) const { return 1 / ggxAlbedo(mu, ggx_.alphaX(), ior_); }

float Gloss::reflectance(Vec3 wo, Vec3 wi) const {
    const Vec3 h = normalize(wo + wi); // both z > 0: never 0
    return fresnelDielectric(std::min(dot(wo, h), 1.f), ior_) * lossless(wo.z);
}

Gloss::Value Gloss::eval(Vec3 wo, Vec3 wi) const {
    if (absent_ || !(wo.z > 0 && wi.z > 0)) return {};
    const float d = ggx_.D(normalize(wo + wi));
    return {reflectance(wo, wi) * (0.25f * d * ggx_.maskingOverCosine(wo, wi)), ggx_.boundedReflection(wo) * d};
}

std::optional<Vec3> Gloss::sample(Vec3 wo, Vec2 u) const {
    if (absent_ || !(wo.z > 0)) return std::nullopt;
    const Vec3 wi = reflect(wo, ggx_.sampleBounded(wo, u));
    return wi.z > 0 ? std::optional(wi) : std::nullopt;
}

float Gloss::weight(Vec3 wo, Vec3 wi) const {
    return reflectance(wo, wi) * (0.25f * ggx_.maskingOverCosine(wo, wi) / ggx_.boundedReflection(wo));
}

} // namespace abbe

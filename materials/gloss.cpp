#include "materials/gloss.h"

#include "base/parallel.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"

#include <cmath>

namespace abbe {

GlossTable::GlossTable(double ior, float roughness) {
    const Gloss gloss(static_cast<float>(ior), roughness);
    constexpr int kSide = 48; // points in each dimension of the sampler's square: error below 1e-4
    parallelFor(kNodes, [&](std::size_t node) {
        const int i = static_cast<int>(node);
        const double root = (gloss.smooth() ? i : std::max(i, 1)) / (kNodes - 1.0), mu = root * root;
        float& albedo = albedo_[node];
        if (gloss.smooth()) {
            albedo = fresnelDielectric(static_cast<float>(mu), gloss.ior_);
            return;
        }
        const Vec3 wo(Vec3d{std::sqrt((1 - mu) * (1 + mu)), 0, mu});
        double sum = 0;
        for (int k = 0; k < kSide * kSide; ++k) {
            const Vec2 u{(static_cast<float>(k % kSide) + 0.5f) / kSide,
                         (static_cast<float>(k / kSide) + 0.5f) / kSide};
            if (const auto wi = gloss.sample(wo, u)) sum += static_cast<double>(gloss.weight(wo, *wi));
        }
        albedo = static_cast<float>(sum / (kSide * kSide));
    });
    constexpr int kCosines = 1000;
    double mean = 0;
    for (int i = 0; i < kCosines; ++i) {
        const float mu = (static_cast<float>(i) + 0.5f) / kCosines;
        mean += static_cast<double>(2 * mu * (gloss.smooth() ? fresnelDielectric(mu, gloss.ior_) : at(mu))) / kCosines;
    }
    mean_ = static_cast<float>(mean);
}

GlossRange::GlossRange(double ior, const schema::TexturedNumber& roughness, KeptTables* kept)
    : ior_(static_cast<float>(ior)), roughness_(roughness, 0, 1) {
    if (std::abs(ior_ - 1) < 1e-6f) return;
    using Tables = std::vector<GlossTable>;
    DigestWriter key("gloss");
    key.number(ior);
    if (!textured()) key.number(roughness.value);
    tables_ = KeptTables::get<Tables>(kept, key.digest(), [&] {
        if (!textured()) return std::make_shared<Tables>(1, GlossTable(ior, static_cast<float>(roughness.value)));
        auto tables = std::make_shared<Tables>(kRoughnesses, GlossTable(ior, 0));
        parallelFor(kRoughnesses - 1, [&](std::size_t i) {
            (*tables)[i + 1] = GlossTable(ior, static_cast<float>(i + 1) / (kRoughnesses - 1));
        });
        return tables;
    });
}

Gloss GlossRange::of(float roughness) const {
    Gloss gloss(ior_, roughness);
    if (!tables_) return gloss;
    gloss.below_ = gloss.above_ = tables_->data();
    if (tables_->size() == 1) return gloss;
    const float x = roughness * (kRoughnesses - 1);
    const int i = std::min(static_cast<int>(x), kRoughnesses - 2);
    gloss.below_ += i;
    gloss.above_ += i + 1;
    gloss.between_ = x - static_cast<float>(i);
    return gloss;
}

float Gloss::albedo(float mu) const {
    if (absent()) return 0;
    if (smooth()) return fresnelDielectric(std::min(mu, 1.f), ior_);
    return lerp(below_->at(mu), above_->at(mu));
}

float Gloss::lossless(float mu) const { return ggxInterface(mu, ggx_.alphaX(), ior_).reflection(); }

float Gloss::reflectance(Vec3 wo, Vec3 wi) const {
    const Vec3 h = normalize(wo + wi); // both z > 0: never 0
    return fresnelDielectric(std::min(dot(wo, h), 1.f), ior_) * lossless(wo.z);
}

Gloss::Value Gloss::eval(Vec3 wo, Vec3 wi) const {
    if (!(wo.z > 0 && wi.z > 0)) return {};
    const float d = ggx_.D(normalize(wo + wi));
    return {reflectance(wo, wi) * (0.25f * d * ggx_.maskingOverCosine(wo, wi)), ggx_.boundedReflection(wo) * d};
}

std::optional<Vec3> Gloss::sample(Vec3 wo, Vec2 u) const {
    if (!(wo.z > 0)) return std::nullopt;
    const Vec3 wi = reflect(wo, ggx_.sampleBounded(wo, u));
    return wi.z > 0 ? std::optional(wi) : std::nullopt;
}

float Gloss::weight(Vec3 wo, Vec3 wi) const {
    return reflectance(wo, wi) * (0.25f * ggx_.maskingOverCosine(wo, wi) / ggx_.boundedReflection(wo));
}

} // namespace abbe

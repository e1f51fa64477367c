#include "integrators/light_sampler.h"

#include <algorithm>

namespace abbe {

LightSampler::LightSampler(const std::vector<std::unique_ptr<const Light>>& lights) {
    double total = 0;
    for (const auto& light : lights) {
        lights_.push_back(light.get());
        total += light->power();
        if (light->infinite()) infinite_.push_back(light.get());
        placed_ |= !light->infinite();
    }
    const double count = static_cast<double>(lights_.size());
    double sum = 0;
    for (const Light* light : lights_) {
        const double byPower = total > 0 ? light->power() / total : 1 / count;
        const double p = 0.5 * byPower + 0.5 / count;
        sum += p;
        cumulative_.push_back(sum);
        probability_.push_back(static_cast<float>(p));
        byLight_[light] = static_cast<float>(p);
        if (light->emission()) byEmission_[light->emission()] = static_cast<float>(p);
    }
}

PickedLight LightSampler::pick(float u, const Receiver&) const noexcept {
    if (lights_.size() == 1) return {lights_.front(), 0, 1};
    const double x = static_cast<double>(u) * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, x);
    const auto i = static_cast<std::size_t>(found - cumulative_.begin());
    return {lights_[i], 0, probability_[i]};
}

PickedLight LightSampler::pickAlong(float u, const Ray& ray, RayExtent) const noexcept { return pick(u, ray.origin); }

float LightSampler::probabilityAlong(const Light* light, std::uint32_t part, const Ray& ray, RayExtent) const noexcept {
    return probability(light, part, ray.origin);
}

float LightSampler::probability(const Light* light, std::uint32_t, const Receiver&) const noexcept {
    if (lights_.size() == 1) return 1;
    const auto found = byLight_.find(light);
    return found != byLight_.end() ? found->second : 0;
}

float LightSampler::probability(const MediumEmission* emission, const Receiver&) const noexcept {
    const auto found = byEmission_.find(emission);
    return found != byEmission_.end() ? found->second : 0;
}

} // namespace abbe

#include "study/effect_prediction.h"

namespace abbe {

namespace {

// Of all paths: fewer than that are others than most, as the short ones in an endless fog, and do not tell what the
// rest would do.
constexpr double kLeastUnscattered = 0.25;

const CostRow* rowOfMedium(const CostReport& cost, const std::string& name) {
    const CostRow* const volume = cost.find("volume " + name);
    return volume ? volume : cost.find("subsurface " + name);
}

std::optional<double> withoutMedium(const CostReport& cost, const CostRow& medium) {
    const auto paths = static_cast<double>(cost.paths), rays = static_cast<double>(cost.untouched);
    const auto scattered = static_cast<double>(medium.first);
    if (!(paths - scattered >= kLeastUnscattered * paths && rays > scattered)) return std::nullopt;
    const double raysWithout = paths * (rays - scattered) / (paths - scattered);
    // Light paths are as many without it.
    double perPath = cost.find("camera")->seconds + cost.find("film")->seconds;
    if (const CostRow* const light = cost.find("light-paths")) perPath += light->seconds;
    const double others = cost.rendering - perPath - medium.seconds - medium.elsewhere;
    return perPath + others * raysWithout / rays;
}

} // namespace

std::optional<double> renderingWithout(const CostReport& cost, const EffectSwitch& effect) {
    switch (effect.effect) {
    case SwitchedEffect::medium: {
        const CostRow* const row = rowOfMedium(cost, effect.medium);
        return row ? withoutMedium(cost, *row) : std::nullopt;
    }
    case SwitchedEffect::motion:
        return cost.rendering - cost.find("motion")->seconds;
    case SwitchedEffect::dispersion: // its paths have one wavelength and the same rays
    case SwitchedEffect::absorption:
    case SwitchedEffect::depthOfField:
        return cost.rendering;
    default:
        return std::nullopt;
    }
}

} // namespace abbe

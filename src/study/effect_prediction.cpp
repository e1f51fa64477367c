#include "study/effect_prediction.h"

namespace abbe {

namespace {

// Of all paths: fewer than that are others than most, as the short ones in an endless fog, and do not tell what the
// rest would do.
constexpr double kLeastUnscattered = 0.25;

const BillRow* rowOfMedium(const Bill& bill, const std::string& name) {
    const BillRow* const volume = bill.find("volume " + name);
    return volume ? volume : bill.find("subsurface " + name);
}

std::optional<double> withoutMedium(const Bill& bill, const BillRow& medium) {
    const auto paths = static_cast<double>(bill.paths), rays = static_cast<double>(bill.untouched);
    const auto scattered = static_cast<double>(medium.first);
    if (!(paths - scattered >= kLeastUnscattered * paths && rays > scattered)) return std::nullopt;
    const double raysWithout = paths * (rays - scattered) / (paths - scattered);
    // Light paths are as many without it.
    double perPath = bill.find("camera")->seconds + bill.find("film")->seconds;
    if (const BillRow* const light = bill.find("light-paths")) perPath += light->seconds;
    const double others = bill.rendering - perPath - medium.seconds - medium.elsewhere;
    return perPath + others * raysWithout / rays;
}

} // namespace

std::optional<double> renderingWithout(const Bill& bill, const EffectSwitch& effect) {
    switch (effect.effect) {
    case SwitchedEffect::medium: {
        const BillRow* const row = rowOfMedium(bill, effect.medium);
        return row ? withoutMedium(bill, *row) : std::nullopt;
    }
    case SwitchedEffect::motion:
        return bill.rendering - bill.find("motion")->seconds;
    case SwitchedEffect::dispersion: // its paths have one wavelength and the same rays
    case SwitchedEffect::absorption:
    case SwitchedEffect::depthOfField:
        return bill.rendering;
    default:
        return std::nullopt;
    }
}

} // namespace abbe

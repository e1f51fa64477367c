#include "media/glow_type.h"

namespace abbe {

std::string_view findContradiction(const GlowParams& p, const MediumOptics& optics, bool temperature, bool color) {
    if (p.emission && (temperature || p.emissivity)) return "`emission` stands alone: it is no factor of a temperature";
    if (p.emissivity && !temperature) return "`emissivity` goes with `temperature`";
    const bool absorbs = optics.extinction->maximum() > 0 && (optics.albedo->minimum() < 1 || color);
    if (temperature && !p.emissivity && !absorbs)
        return "a hot medium shines by what it absorbs, and this one absorbs nothing: give it an `albedo` below 1, "
               "`absorption`, or an `emissivity`";
    return {};
}

std::optional<Glow> makeGlow(const GlowParams& p, const MediumOptics& optics, bool temperature) {
    if (p.emission) return Glow::ofSpectrum(*p.emission);
    if (!temperature) return std::nullopt;
    if (p.emissivity) return Glow::ofTemperature(*p.emissivity);
    return Glow::ofTemperature(*optics.extinction, *optics.albedo);
}

} // namespace abbe

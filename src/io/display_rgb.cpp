#include "io/display_rgb.h"

namespace abbe {

Matrix3 toDisplayRgb(const std::optional<Chromaticities>& chromaticities) {
    if (!chromaticities || chromaticities->matches(rgb::rec709)) return {};
    const RgbSpace space = chromaticities->space();
    return rgb::rec709.fromXyz() * adaptation(whiteXyz(space.white), whiteXyz(rgb::rec709.white)) * space.toXyz();
}

} // namespace abbe

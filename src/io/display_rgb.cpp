#include "io/display_rgb.h"

namespace abbe {

Matrix3 toDisplayRgb(const RgbImage& image) {
    if (!image.chromaticities) return {};
    const RgbSpace space = image.chromaticities->space();
    const bool neutral = image.adoptedNeutral && image.adoptedNeutral->y > 0;
    const Chromaticity white = neutral ? *image.adoptedNeutral : space.white;
    return rgb::rec709.fromXyz() * adaptation(whiteXyz(white), whiteXyz(rgb::rec709.white)) * space.toXyz();
}

Matrix3 toDisplayRgb(const RgbImage& image, const RgbImage& reference) {
    return toDisplayRgb(reference.chromaticities ? reference : image);
}

} // namespace abbe

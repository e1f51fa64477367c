// The colours of images as a display of our day would be sent them: linear Rec.709 with the white at D65.
#pragma once

#include "io/image.h"
#include "spectrum/matrix3.h"

namespace abbe {

// From the linear RGB of an image (Rec.709 if it names no primaries, as OpenEXR says) to linear Rec.709. What the image
// takes for white, its adopted neutral or else the white of its space, becomes D65 by Bradford's adaptation. Nothing is
// clipped: components may be negative.
Matrix3 toDisplayRgb(const RgbImage&);
// The same for two images of one space, of which only one may name it.
Matrix3 toDisplayRgb(const RgbImage& image, const RgbImage& reference);

} // namespace abbe

// The colours of images as a display of our day would be sent them: linear Rec.709 with the white at D65.
#pragma once

#include "io/image.h"
#include "spectrum/matrix3.h"

namespace abbe {

// From linear RGB of these chromaticities (Rec.709 if there are none, as OpenEXR says) to linear Rec.709; the white
// becomes D65 by Bradford's adaptation. Nothing is clipped: components may be negative.
Matrix3 toDisplayRgb(const std::optional<Chromaticities>&);

} // namespace abbe

// The three components of which CIE daylight of any colour is made [CIE015, sec. 4.1].
#pragma once

#include "spectrum/color_space.h"
#include "spectrum/sampled_curve.h"

namespace abbe {

// S(λ) = S0 + m1 S1 + m2 S2, of any scale.
struct DaylightBasis {
    DaylightBasis();
    SampledCurve s0, s1, s2; // linear between the tabulated tens of nanometres
};

// The weights for a chromaticity. Requires: near that of daylight or of a blue sky, x 0.2 … 0.5.
struct DaylightWeights {
    double m1 = 0, m2 = 0;
};
DaylightWeights daylightWeights(Chromaticity);

} // namespace abbe

// Luminance and colour of a clear or hazy sky [Preetham1999]: Perez' distribution with coefficients fitted to
// simulated skies. Good for turbidities of 2 to 6, usable to 10, with the sun above the horizon.
#pragma once

#include "spectrum/color_space.h"

namespace abbe {

class PreethamSky {
  public:
    // The sun's angle from the zenith, rad. Requires: 0 <= sunZenith < π/2, turbidity 2 … 10.
    PreethamSky(double sunZenith, double turbidity);

    struct Value {
        double luminance = 0; // cd/m², >= 0
        Chromaticity chromaticity;
    };
    // At the angle from the zenith whose cosine is given, > 0, and at the angle `fromSun` (rad).
    Value at(double cosZenith, double fromSun) const;
    Value zenith() const { return {zenith_[0], {zenith_[1], zenith_[2]}}; }

  private:
    // [Perez1993, eq. 1]: darkening or brightening of the horizon, its gradient, the brightness around the sun, its
    // width, and scattering backwards.
    struct Perez {
        double a, b, c, d, e;
        double at(double cosZenith, double fromSun) const;
    };
    Perez perez_[3];     // of Y, x, y
    double zenith_[3];   // Y in cd/m², x, y
    double relative_[3]; // the zenith's value over that of perez_ there
};

} // namespace abbe

// CIELAB and colour differences, for reports and tests.
#pragma once

#include "spectrum/xyz.h"

namespace abbe {

// CIE 1976 L*, a*, b*.
struct Lab {
    double l = 0, a = 0, b = 0;
};

// Negative tristimulus values are allowed: the linear branch goes on.
Lab toLab(const Xyz&, const Xyz& white);

// Euclidean distance (CIE 1976).
double deltaE76(const Lab&, const Lab&);
// CIEDE2000 with kL = kC = kH = 1 [Sharma2005].
double deltaE2000(const Lab&, const Lab&);

} // namespace abbe

#include "spectrum/lab.h"

#include "math/vec.h"

#include <cmath>

namespace abbe {

namespace {

double labCurve(double t) {
    constexpr double d = 6.0 / 29;
    return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

constexpr double radians(double degrees) { return degrees * (kPiD / 180); }

// Hue angle in [0, 360).
double hue(double a, double b) {
    if (a == 0 && b == 0) return 0;
    const double h = std::atan2(b, a) * (180 / kPiD);
    return h < 0 ? h + 360 : h;
}

double power7(double x) { return x * x * x * x * x * x * x; }

} // namespace

Lab toLab(const Xyz& c, const Xyz& white) {
    const double x = labCurve(c.x / white.x), y = labCurve(c.y / white.y), z = labCurve(c.z / white.z);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double deltaE76(const Lab& p, const Lab& q) {
    return std::sqrt(square(p.l - q.l) + square(p.a - q.a) + square(p.b - q.b));
}

// [Sharma2005, eq. 2 to 22], symbols as there.
double deltaE2000(const Lab& p, const Lab& q) {
    constexpr double twentyFive7 = 6103515625.0; // 25⁷
    const double meanC = 0.5 * (std::hypot(p.a, p.b) + std::hypot(q.a, q.b));
    const double g = 0.5 * (1 - std::sqrt(power7(meanC) / (power7(meanC) + twentyFive7)));
    const double a1 = (1 + g) * p.a, a2 = (1 + g) * q.a;
    const double c1 = std::hypot(a1, p.b), c2 = std::hypot(a2, q.b);
    const double h1 = hue(a1, p.b), h2 = hue(a2, q.b);

    double dh = h2 - h1, meanH = 0.5 * (h1 + h2);
    if (c1 * c2 == 0) {
        dh = 0;
        meanH = h1 + h2;
    } else if (std::abs(dh) > 180) {
        dh += dh > 0 ? -360 : 360;
        meanH += h1 + h2 < 360 ? 180 : -180;
    }
    const double dL = q.l - p.l, dC = c2 - c1;
    const double dH = 2 * std::sqrt(c1 * c2) * std::sin(radians(0.5 * dh));

    const double l = 0.5 * (p.l + q.l), c = 0.5 * (c1 + c2);
    const double t = 1 - 0.17 * std::cos(radians(meanH - 30)) + 0.24 * std::cos(radians(2 * meanH)) +
                     0.32 * std::cos(radians(3 * meanH + 6)) - 0.20 * std::cos(radians(4 * meanH - 63));
    const double sl = 1 + 0.015 * square(l - 50) / std::sqrt(20 + square(l - 50));
    const double sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
    const double rotation = 60 * std::exp(-square((meanH - 275) / 25));
    const double rt = -std::sin(radians(rotation)) * 2 * std::sqrt(power7(c) / (power7(c) + twentyFive7));
    return std::sqrt(square(dL / sl) + square(dC / sc) + square(dH / sh) + rt * (dC / sc) * (dH / sh));
}

} // namespace abbe

#include "lights/preetham_sky.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// [Preetham1999, appendix A.2]: slopes in turbidity and constants.
constexpr double kLines[3][5][2] = {
    {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
    {{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}},
    {{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}}};

// Chromaticity of the zenith: rows for T², T, 1, columns for θ³, θ², θ, 1.
constexpr double kZenithX[3][4] = {
    {0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}};
constexpr double kZenithY[3][4] = {
    {0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}};

double zenithChromaticity(const double (&m)[3][4], double angle, double turbidity) {
    const auto row = [&](int i) { return ((m[i][0] * angle + m[i][1]) * angle + m[i][2]) * angle + m[i][3]; };
    return (row(0) * turbidity + row(1)) * turbidity + row(2);
}

} // namespace

double PreethamSky::Perez::at(double cosZenith, double fromSun) const {
    const double cosine = std::cos(fromSun);
    return (1 + a * std::exp(b / std::max(cosZenith, 1e-4))) * (1 + c * std::exp(d * fromSun) + e * cosine * cosine);
}

PreethamSky::PreethamSky(double sunZenith, double t) {
    const double chi = (4.0 / 9 - t / 120) * (kPiD - 2 * sunZenith);
    zenith_[0] = 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);
    zenith_[1] = zenithChromaticity(kZenithX, sunZenith, t);
    zenith_[2] = zenithChromaticity(kZenithY, sunZenith, t);
    for (int i = 0; i < 3; ++i) {
        const auto line = [&](int k) { return kLines[i][k][0] * t + kLines[i][k][1]; };
        perez_[i] = {line(0), line(1), line(2), line(3), line(4)};
        relative_[i] = zenith_[i] / perez_[i].at(1, sunZenith);
    }
}

PreethamSky::Value PreethamSky::at(double cosZenith, double fromSun) const {
    const auto value = [&](int i) { return relative_[i] * perez_[i].at(cosZenith, fromSun); };
    return {std::max(value(0), 0.0), {value(1), value(2)}};
}

} // namespace abbe

#include "lights/solar_spectrum.h"

#include "math/vec.h"
#include "spectrum/emission_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace abbe {

namespace {

constexpr double kOzone = 0.35, kWater = 2; // cm
constexpr double kSunTemperature = 5778;    // K
constexpr double kMeanHalfAngle = 0.2666 * kPiD / 180;

// Radiance of the sun outside of the atmosphere from 380 to 750 nm in steps of 10 nm, W·cm⁻²·μm⁻¹·sr⁻¹
// [Preetham1999, table 2].
constexpr double kSunRadiance[] = {
    1655.9,  1623.37, 2112.75, 2588.82, 2582.91, 2423.23, 2676.05, 2965.83, 3054.54, 3005.75, 3066.37, 2883.04, 2871.21,
    2782.5,  2710.06, 2723.36, 2636.13, 2550.38, 2506.02, 2531.16, 2535.59, 2513.42, 2463.15, 2417.32, 2368.53, 2321.21,
    2282.77, 2233.98, 2197.02, 2152.67, 2109.79, 2072.83, 2024.04, 1987.08, 1942.72, 1907.24, 1862.89, 1825.92};

using Point = std::pair<double, double>;
// Absorption coefficients: ozone in 1/cm, water vapour in 1/cm, mixed gases in 1/km [Iqbal1983, after Leckner].
constexpr Point kOzoneAbsorption[] = {
    {355, 0},     {440, 0},     {445, 0.003}, {450, 0.003}, {455, 0.004}, {460, 0.006}, {465, 0.008}, {470, 0.009},
    {475, 0.012}, {480, 0.014}, {485, 0.017}, {490, 0.021}, {495, 0.025}, {500, 0.030}, {505, 0.035}, {510, 0.040},
    {515, 0.045}, {520, 0.048}, {525, 0.057}, {530, 0.063}, {535, 0.070}, {540, 0.075}, {545, 0.080}, {550, 0.085},
    {555, 0.095}, {560, 0.103}, {565, 0.110}, {570, 0.120}, {575, 0.122}, {580, 0.120}, {585, 0.118}, {590, 0.115},
    {595, 0.120}, {600, 0.125}, {605, 0.130}, {610, 0.120}, {615, 0.105}, {620, 0.090}, {625, 0.079}, {630, 0.067},
    {635, 0.057}, {640, 0.048}, {645, 0.036}, {650, 0.028}, {655, 0.023}, {660, 0.018}, {665, 0.014}, {670, 0.011},
    {675, 0.010}, {680, 0.009}, {685, 0.007}, {690, 0.004}, {695, 0}};
constexpr Point kWaterAbsorption[] = {
    {689, 0},       {690, 0.016},   {700, 0.024},  {710, 0.0125}, {720, 1},     {730, 0.87}, {740, 0.061}, {750, 0.001},
    {760, 0.00001}, {770, 0.00001}, {780, 0.0006}, {790, 0.0175}, {800, 0.036}, {810, 0.33}, {820, 1.53},  {830, 0.66}};
constexpr Point kGasAbsorption[] = {{759, 0}, {760, 3}, {770, 0.21}, {771, 0}};

template <std::size_t N> double interpolate(const Point (&table)[N], double nm) {
    if (nm <= table[0].first) return table[0].second;
    for (std::size_t i = 1; i < N; ++i)
        if (nm <= table[i].first)
            return std::lerp(table[i - 1].second, table[i].second,
                             (nm - table[i - 1].first) / (table[i].first - table[i - 1].first));
    return table[N - 1].second;
}

double extraterrestrial(double nm) { // W·m⁻²·nm⁻¹·sr⁻¹
    constexpr double first = 380, last = 750, step = 10;
    const double inside = std::clamp(nm, first, last);
    const auto i = std::min(static_cast<std::size_t>((inside - first) / step), std::size(kSunRadiance) - 2);
    const double t = (inside - first) / step - static_cast<double>(i);
    const double beyond =
        inside == nm ? 1 : planckRadiance(nm, kSunTemperature) / planckRadiance(inside, kSunTemperature);
    return 10 * beyond * std::lerp(kSunRadiance[i], kSunRadiance[i + 1], t);
}

double transmittance(double nm, double airMass, double turbidity) {
    const double um = nm * 1e-3, m = airMass;
    const double aerosol = 0.04608 * turbidity - 0.04586;
    const double gas = interpolate(kGasAbsorption, nm) * m, water = interpolate(kWaterAbsorption, nm) * kWater * m;
    return std::exp(-m * 0.008735 * std::pow(um, -4.08) - m * aerosol * std::pow(um, -1.3) -
                    m * interpolate(kOzoneAbsorption, nm) * kOzone - 1.41 * gas / std::pow(1 + 118.93 * gas, 0.45) -
                    0.2385 * water / std::pow(1 + 20.07 * water, 0.45));
}

} // namespace

double relativeAirMass(double zenithAngle) {
    return 1 / (std::cos(zenithAngle) + 0.15 * std::pow(93.885 - zenithAngle * 180 / kPiD, -1.253));
}

SampledCurve solarIrradiance(double zenithAngle, double turbidity) {
    const double airMass = relativeAirMass(zenithAngle), projected = kPiD * square(std::sin(kMeanHalfAngle));
    return SampledCurve(
        [&](double nm) { return extraterrestrial(nm) * projected * transmittance(nm, airMass, turbidity); });
}

} // namespace abbe

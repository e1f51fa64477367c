#include "lights/solar_spectrum.h"

#include "math/vec.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace abbe {

namespace {

constexpr double kWater = 2; // cm

// Irradiance by the sun outside of the atmosphere, W·m⁻²·nm⁻¹, from 360 to 830 nm in steps of 5 nm: means of
// [ASTMG173] under the hats of linear interpolation.
constexpr double kSolarFirst = 360, kSolarStep = 5;
constexpr double kSolarIrradiance[] = {
    0.953, 1.131, 1.183, 1.093, 1.137, 0.968, 1.116, 1.054, 1.562, 1.718, 1.700, 1.755, 1.727, 1.703, 1.482, 1.706,
    1.799, 1.916, 2.024, 2.022, 2.041, 2.015, 1.992, 2.033, 2.052, 1.905, 1.908, 1.963, 1.909, 1.925, 1.929, 1.824,
    1.806, 1.866, 1.894, 1.886, 1.843, 1.869, 1.865, 1.858, 1.822, 1.833, 1.833, 1.843, 1.834, 1.826, 1.761, 1.788,
    1.761, 1.758, 1.729, 1.688, 1.696, 1.670, 1.663, 1.643, 1.630, 1.608, 1.578, 1.503, 1.533, 1.556, 1.533, 1.508,
    1.493, 1.467, 1.468, 1.444, 1.420, 1.413, 1.394, 1.366, 1.346, 1.346, 1.322, 1.317, 1.283, 1.287, 1.275, 1.269,
    1.255, 1.235, 1.214, 1.208, 1.197, 1.187, 1.168, 1.141, 1.138, 1.123, 1.113, 1.108, 1.078, 1.072, 1.059};

using AbsorptionPoint = std::pair<double, double>;
// Absorption coefficients: water vapour in 1/cm, mixed gases in 1/km [Iqbal1983, after Leckner].
constexpr AbsorptionPoint kWaterAbsorption[] = {
    {689, 0},       {690, 0.016},   {700, 0.024},  {710, 0.0125}, {720, 1},     {730, 0.87}, {740, 0.061}, {750, 0.001},
    {760, 0.00001}, {770, 0.00001}, {780, 0.0006}, {790, 0.0175}, {800, 0.036}, {810, 0.33}, {820, 1.53},  {830, 0.66}};
constexpr AbsorptionPoint kGasAbsorption[] = {{759, 0}, {760, 3}, {770, 0.21}, {771, 0}};

template <std::size_t N> double absorption(const AbsorptionPoint (&table)[N], double nm) {
    if (nm <= table[0].first) return table[0].second;
    for (std::size_t i = 1; i < N; ++i)
        if (nm <= table[i].first)
            return std::lerp(table[i - 1].second, table[i].second,
                             (nm - table[i - 1].first) / (table[i].first - table[i - 1].first));
    return table[N - 1].second;
}

} // namespace

double relativeAirMass(double zenithAngle) {
    return 1 / (std::cos(zenithAngle) + 0.15 * std::pow(93.885 - zenithAngle * 180 / kPiD, -1.253));
}

double solarIrradianceInSpace(double nm) {
    const double x = std::clamp((nm - kSolarFirst) / kSolarStep, 0.0, std::size(kSolarIrradiance) - 1.0);
    const auto i = std::min(static_cast<std::size_t>(x), std::size(kSolarIrradiance) - 2);
    return std::lerp(kSolarIrradiance[i], kSolarIrradiance[i + 1], x - static_cast<double>(i));
}

double gasTransmittance(double nm, double airMass) {
    const double gas = absorption(kGasAbsorption, nm) * airMass,
                 water = absorption(kWaterAbsorption, nm) * kWater * airMass;
    return std::exp(-1.41 * gas / std::pow(1 + 118.93 * gas, 0.45) -
                    0.2385 * water / std::pow(1 + 20.07 * water, 0.45));
}

SampledCurve solarIrradiance(double zenithAngle, const AirParams& params) {
    const double cosine = std::cos(zenithAngle);
    if (!(cosine > 0)) return SampledCurve([](double) { return 0; });
    const AirMasses m = ClearAir(params).airMasses(cosine);
    const double airMass = relativeAirMass(zenithAngle);
    return SampledCurve([&](double nm) {
        const double depth = m.molecules * rayleighDepth(nm) + m.aerosol * aerosolDepth(nm, params.turbidity) +
                             m.ozone * ozoneDepth(nm, params.ozone);
        return solarIrradianceInSpace(nm) * gasTransmittance(nm, airMass) * std::exp(-depth);
    });
}

} // namespace abbe

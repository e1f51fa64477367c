#include "schema/unit.h"

#include "math/vec.h"

#include <array>

namespace abbe::schema {

namespace {
constexpr double kFoot = 0.3048; // exact by the international yard of 1959
constexpr double kInch = 0.0254;

// Spellings with their prefixes, grouped by dimension. Scales are written out so that each is the nearest
// double of the exact decimal.
constexpr std::array kUnits = {
    Unit{"m", Dimension::length, 1},
    Unit{"cm", Dimension::length, 0.01},
    Unit{"mm", Dimension::length, 0.001},
    Unit{"km", Dimension::length, 1000},
    Unit{"um", Dimension::length, 1e-6},
    Unit{"µm", Dimension::length, 1e-6},
    Unit{"nm", Dimension::length, 1e-9},
    Unit{"in", Dimension::length, kInch},
    Unit{"ft", Dimension::length, kFoot},
    Unit{"deg", Dimension::angle, kDegree},
    Unit{"rad", Dimension::angle, 1},
    Unit{"mrad", Dimension::angle, 0.001},
    Unit{"turn", Dimension::angle, 2 * kPiD},
    Unit{"s", Dimension::time, 1},
    Unit{"ms", Dimension::time, 0.001},
    Unit{"us", Dimension::time, 1e-6},
    Unit{"ns", Dimension::time, 1e-9},
    Unit{"min", Dimension::time, 60},
    Unit{"h", Dimension::time, 3600},
    Unit{"K", Dimension::temperature, 1},
    Unit{"W", Dimension::power, 1},
    Unit{"mW", Dimension::power, 0.001},
    Unit{"kW", Dimension::power, 1000},
    Unit{"lm", Dimension::luminousFlux, 1},
    Unit{"klm", Dimension::luminousFlux, 1000},
    Unit{"cd", Dimension::luminousIntensity, 1},
    Unit{"kcd", Dimension::luminousIntensity, 1000},
    Unit{"lx", Dimension::illuminance, 1},
    Unit{"klx", Dimension::illuminance, 1000},
    Unit{"W-per-m2", Dimension::irradiance, 1},
    Unit{"nits", Dimension::luminance, 1},
    Unit{"cd-per-m2", Dimension::luminance, 1},
    Unit{"per-m", Dimension::inverseLength, 1},
    Unit{"per-cm", Dimension::inverseLength, 100},
    Unit{"per-mm", Dimension::inverseLength, 1000},
    Unit{"per-km", Dimension::inverseLength, 0.001},
    Unit{"stops", Dimension::stops, 1},
    Unit{"EV", Dimension::stops, 1},
    Unit{"%", Dimension::fraction, 0.01},
    Unit{"px", Dimension::pixels, 1},
};

struct DimensionWords {
    std::string_view description;
    std::string_view si;
};

constexpr DimensionWords words(Dimension d) {
    switch (d) {
    case Dimension::none:
        return {"a plain number", ""};
    case Dimension::length:
        return {"a length", "m"};
    case Dimension::angle:
        return {"an angle", "rad"};
    case Dimension::time:
        return {"a time", "s"};
    case Dimension::temperature:
        return {"a temperature", "K"};
    case Dimension::power:
        return {"a power", "W"};
    case Dimension::luminousFlux:
        return {"a luminous flux", "lm"};
    case Dimension::luminousIntensity:
        return {"a luminous intensity", "cd"};
    case Dimension::illuminance:
        return {"an illuminance", "lx"};
    case Dimension::irradiance:
        return {"an irradiance", "W-per-m2"};
    case Dimension::luminance:
        return {"a luminance", "nits"};
    case Dimension::inverseLength:
        return {"an inverse length", "per-m"};
    case Dimension::stops:
        return {"a number of stops", "stops"};
    case Dimension::fraction:
        return {"a fraction", ""};
    case Dimension::pixels:
        return {"a number of pixels", "px"};
    }
    return {};
}

constexpr auto kLengths = std::to_array<std::string_view>({"mm", "cm", "m", "in", "ft", "km", "um", "nm"});
constexpr auto kAngles = std::to_array<std::string_view>({"deg", "rad", "turn", "mrad"});
constexpr auto kTimes = std::to_array<std::string_view>({"s", "ms", "us", "ns", "min", "h"});
constexpr auto kTemperatures = std::to_array<std::string_view>({"K"});
constexpr auto kPowers = std::to_array<std::string_view>({"W", "mW", "kW"});
constexpr auto kFluxes = std::to_array<std::string_view>({"lm", "klm"});
constexpr auto kIntensities = std::to_array<std::string_view>({"cd", "kcd"});
constexpr auto kIlluminances = std::to_array<std::string_view>({"lx", "klx"});
constexpr auto kIrradiances = std::to_array<std::string_view>({"W-per-m2"});
constexpr auto kLuminances = std::to_array<std::string_view>({"nits", "cd-per-m2"});
constexpr auto kInverseLengths = std::to_array<std::string_view>({"per-m", "per-cm", "per-mm", "per-km"});
constexpr auto kStops = std::to_array<std::string_view>({"stops", "EV"});
constexpr auto kFractions = std::to_array<std::string_view>({"%"});
constexpr auto kPixels = std::to_array<std::string_view>({"px"});

} // namespace

std::optional<Unit> findUnit(std::string_view name) {
    for (const Unit& unit : kUnits)
        if (unit.name == name) return unit;
    return std::nullopt;
}

std::string_view describe(Dimension d) { return words(d).description; }

std::string_view siUnit(Dimension d) { return words(d).si; }

double largest(Dimension d) {
    switch (d) {
    case Dimension::length:
    case Dimension::inverseLength:
    case Dimension::time:
        return 1e15;
    case Dimension::temperature:
    case Dimension::pixels:
        return 1e9;
    case Dimension::stops:
        return 1000;
    case Dimension::power:
    case Dimension::luminousFlux:
    case Dimension::luminousIntensity:
    case Dimension::illuminance:
    case Dimension::irradiance:
    case Dimension::luminance:
        return 1e35; // more than a star's; what it comes to is checked with the light (lights/amount.h)
    case Dimension::none:
    case Dimension::angle:
    case Dimension::fraction:
        break;
    }
    return 1e30;
}

std::span<const std::string_view> spellings(Dimension d) {
    switch (d) {
    case Dimension::none:
        return {};
    case Dimension::length:
        return kLengths;
    case Dimension::angle:
        return kAngles;
    case Dimension::time:
        return kTimes;
    case Dimension::temperature:
        return kTemperatures;
    case Dimension::power:
        return kPowers;
    case Dimension::luminousFlux:
        return kFluxes;
    case Dimension::luminousIntensity:
        return kIntensities;
    case Dimension::illuminance:
        return kIlluminances;
    case Dimension::irradiance:
        return kIrradiances;
    case Dimension::luminance:
        return kLuminances;
    case Dimension::inverseLength:
        return kInverseLengths;
    case Dimension::stops:
        return kStops;
    case Dimension::fraction:
        return kFractions;
    case Dimension::pixels:
        return kPixels;
    }
    return {};
}

} // namespace abbe::schema

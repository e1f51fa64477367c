// Units and their dimensions: the one table of what may stand after a number.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace abbe::schema {

// `none` is a plain number. Light has radiometric and photometric dimensions, which never mix.
enum class Dimension : unsigned char {
    none,
    length,            // m
    angle,             // rad
    time,              // s
    temperature,       // K
    power,             // W
    luminousFlux,      // lm
    luminousIntensity, // cd
    illuminance,       // lx
    irradiance,        // W/m²
    luminance,         // cd/m² (nits)
    inverseLength,     // 1/m
    stops,             // powers of two
    fraction,          // 1 (% is 0.01)
    pixels,
};

struct Unit {
    std::string_view name; // as written, with its prefix: "mm", "klx"
    Dimension dimension;
    double scale; // SI value of one unit
};

// The unit spelled `name` (prefixes n u m c k M where they make sense), or nothing.
std::optional<Unit> findUnit(std::string_view name);
// "a length", "an angle": for messages. "m", "rad": the SI unit a dimension is stored in.
std::string_view describe(Dimension);
std::string_view siUnit(Dimension);
// The largest magnitude of an SI value that a scene may state; properties may allow less. Far beyond what there is, and
// near enough that squares, products and sums of a few of them still fit single precision.
double largest(Dimension);
// Spellings offered for a dimension in messages and the manual, commonest first.
std::span<const std::string_view> spellings(Dimension);

} // namespace abbe::schema

// Luminous intensity of a light by direction, as photometric files of type C hold it.
#pragma once

#include <cstddef>
#include <vector>

namespace abbe {

// Which part of the circle about the axis the planes cover; the rest is mirrored.
enum class PlaneSymmetry : unsigned char {
    axial,   // one plane: the same all around
    quarter, // 0 … 90°
    half,    // 0 … 180°, mirrored at the plane of 0 and 180°
    across,  // 90 … 270°, mirrored at the plane of 90 and 270°
    none     // 0 … 360°
};

struct IntensityTable {
    std::vector<double> vertical;   // rad from the axis, increasing, within [0, π]; no light beyond its ends
    std::vector<double> horizontal; // rad about the axis, increasing; of the last plane 2π where there is no symmetry
    PlaneSymmetry symmetry = PlaneSymmetry::axial;
    std::vector<double> candela; // plane by plane, >= 0

    double at(std::size_t plane, std::size_t angle) const { return candela[plane * vertical.size() + angle]; }
};

} // namespace abbe

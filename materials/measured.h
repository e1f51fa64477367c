// Surfaces whose scattering was measured at many pairs of directions, in the parametrisation of [Dupuy2018].
#pragma once

#include "math/bilinear_warp.h"
#include "render/material.h"
#include "schema/type.h"

#include <memory>
#include <vector>

namespace abbe {

struct MeasuredParams {
    schema::Text file;
    double scale = 1; // factor on all that is reflected
};

// A grid of numbers over the unit square; bilinear.
struct MeasuredGrid {
    std::vector<float> values; // row by row
    std::size_t rows = 0, columns = 0;
    double at(Vec2d) const noexcept;
};

// What a file holds. Directions on the unit square: θ = u² π/2 along a row, φ = (2 v - 1) π from row to row.
struct MeasuredTables {
    std::vector<float> phi, theta;   // rad, of the direction that is looked from; increasing
    std::vector<float> wavelengths;  // nm, increasing
    int repeats = 1;                 // how often the measured range of phi makes a circle: 1, 2 or 4
    bool isotropic = true;           // phi of microfacets counts from that of the direction
    bool scalesByFacets = true;      // the spectra are to be multiplied by D / (4 σ)
    MeasuredGrid facets, projected;  // D, by the half vector; σ, by direction
    BilinearWarp visible, luminance; // by phi and theta: of half vectors; of what `visible` makes uniform
    std::vector<float> spectra;      // by phi, theta, such a place and wavelength: f cos θ but for the factor above
    std::size_t side = 0;            // such places in a row, and rows
};

schema::TypeInfo measuredType();
std::unique_ptr<const Material> makeMeasured(MeasuredTables, double scale);

} // namespace abbe

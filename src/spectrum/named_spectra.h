// The library of published spectra and optical constants that ships with the renderer. Names are compared without
// regard to case. Views point at static data.
#pragma once

#include "spectrum/curve.h"
#include "spectrum/dispersion.h"

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace abbe {

// Values at firstNm, firstNm + stepNm, …
struct NamedSpectrum {
    std::string_view name;
    std::string_view source;
    double firstNm = 0, stepNm = 0;
    std::span<const double> values;
};

// A transparent solid or liquid. kNm and k are empty where absorption is not tabulated.
struct Glass {
    std::string_view name;
    std::string_view source;
    DispersionFormula formula = DispersionFormula::sellmeierSquared;
    std::span<const double> coefficients;
    double minNm = 0, maxNm = 0; // range of the formula
    std::span<const double> kNm; // wavelengths of k
    std::span<const double> k;   // extinction coefficient, imaginary part of the index
};

// An opaque conductor (or semiconductor): complex index n + i k.
struct Metal {
    std::string_view name;
    std::string_view source;
    std::span<const double> nm;
    std::span<const double> n;
    std::span<const double> k;
};

std::optional<NamedSpectrum> findIlluminant(std::string_view name); // "D65", "FL11", also "F11"
std::optional<NamedSpectrum> findMeasured(std::string_view name);   // "cornell-white", "macbeth-13", also "blue"
std::optional<Glass> findGlass(std::string_view name);              // "N-BK7", also "BK7"
std::optional<Metal> findMetal(std::string_view name);              // "Au", also "gold"

// Names and aliases, for suggestions.
std::vector<std::string_view> illuminantNames();
std::vector<std::string_view> measuredNames();
std::vector<std::string_view> glassNames();
std::vector<std::string_view> metalNames();

// Relative spectral power scaled to Y = 1 (see sensor.h), resampled with its energy kept.
std::unique_ptr<Curve> illuminantCurve(const NamedSpectrum&);
// A quantity without unit, constant beyond its table.
std::unique_ptr<Curve> reflectanceCurve(const NamedSpectrum&);
std::unique_ptr<Curve> indexCurve(const Glass&);
// Absorption coefficient 4π k / λ in 1/m; zero where k is not tabulated.
std::unique_ptr<Curve> absorptionCurve(const Glass&);
std::unique_ptr<Curve> indexCurve(const Metal&);
std::unique_ptr<Curve> extinctionCurve(const Metal&);

} // namespace abbe

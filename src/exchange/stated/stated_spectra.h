// Spectra and amounts of light as other formats write them.
#pragma once

#include "exchange/stated/stated_scene.h"

#include <optional>
#include <utility>
#include <vector>

namespace abbe::exchange {

struct Export;

// Twelve digits of what was computed, so that writing, reading and writing again gives the same text.
double rounded(double);

// A spectrum in one of the forms that all formats have.
struct PlainSpectrum {
    enum class Form : std::uint8_t { flat, rgb, blackbody, table } form = Form::flat;
    double value = 0;                            // flat; K of a black body
    Vec3d rgb;                                   // linear Rec. 709
    std::vector<std::pair<double, double>> rows; // nm, value; rising. Also of colours above 1 that are no light
    bool light = false;                          // of light: a table is zero beyond its ends, else it goes on there
};

// `scale` times the curve. Black bodies keep their form where the scale is 1, colours where they are within Rec. 709
// (and at most 1, for reflectances); all else becomes a table, every `step` nm where it is not one already.
PlainSpectrum plainSpectrum(const StatedCurve&, double scale = 1, double step = 5);

// The colour of a spectrum in linear Rec. 709: of light as it is, of a reflectance under D65.
Vec3d rgbOf(const StatedCurve&, const StatedCurve& daylight);

// What importers take a flat spectrum of 1 for, in nits, and the luminance of a colour: exports are their inverse.
struct LightUnits {
    double nits;
    Vec3d luminance; // of red, green and blue
};
inline constexpr LightUnits kMitsubaUnits = {72983, {0.2126, 0.7152, 0.0722}};
const LightUnits& exactUnits();

// Y, where a flat spectrum of 1 has 1.
double luminanceOf(const StatedCurve&, const LightUnits&);

// An absolute spectrum: radiance, or intensity of lights without extent.
struct StatedLight {
    const StatedCurve* curve = nullptr;
    double scale = 0;
};

// What a light's geometry makes of it.
struct LightFactors {
    double power = 0;      // flux over radiance or intensity: m² sr, sr
    double irradiance = 0; // irradiance over radiance: sr; 1 where the spectrum is an irradiance
    LightUnits units = kMitsubaUnits;
};

// The light that a definition states by one of the amounts and a colour, or `otherwise` in nits (lx); nothing if it
// states none.
std::optional<StatedLight> statedLight(const StatedThing&, const LightFactors&, const StatedScene&,
                                       std::optional<double> otherwise = {});

// A sun of one direction: its irradiance. One with a width is W0802.
StatedLight statedSun(const StatedThing&, Export&, const LightUnits& = kMitsubaUnits);
// Direction in which light of a sun or daylight travels, in the world.
Vec3d sunToward(const Placed&, const StatedThing&, const StatedScene&);

// Place and axis of a spot or beam, of any length, in the world.
std::pair<Vec3d, Vec3d> axisOfLight(const Placed&, const StatedThing&);
// +z to the axis, of any length; rigid.
Transform mapToAxis(Vec3d place, Vec3d axis);

// What a pixel of 1 of an environment is.
double environmentScale(const StatedThing&);
// From a space where the image's middle lies towards −z and its top is +y.
Transform environmentToWorld(const Placed&, const StatedScene&);

// Index at the sodium D line, and whether it varies.
double indexAtD(const StatedCurve&);

} // namespace abbe::exchange

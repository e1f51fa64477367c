// What `film { … }` says.
#pragma once

#include "film/pixel_filter.h"
#include "render/film.h"
#include "schema/type.h"
#include "spectrum/color_space.h"
#include "spectrum/sensor.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

struct FilmParams {
    Vec2d size{1280, 720};                        // pixels
    std::optional<std::vector<double>> crop;      // x0 y0 x1 y1, half-open, pixels from the top left
    std::vector<double> overscan;                 // pixels beyond the edges: left, top, right, bottom, or one for all
    schema::Choice filter{"blackman-harris", {}}; // radius in pixels; unset: defaultRadius of the filter
    schema::Text output;                          // empty: named after the scene
    schema::Choice sensor{"cie", {}};             // or a name of sensorNames()
    const Curve* whiteBalance = nullptr;          // light that shall look neutral; null: colours stay as they are
    schema::TableRows layers;                     // film/layer_plan.h
};

schema::TypeInfo filmType();

// Linear encodings of the written image. Of `xyz` R, G, B are X, Y, Z.
enum class OutputSpace : std::uint8_t { aces2065_1, acescg, rec709, xyz };
const RgbSpace& rgbSpace(OutputSpace);
// Name for people: "ACES2065-1".
std::string_view spaceName(OutputSpace);
// The chromaticity that looks neutral: the white of the space; of XYZ, which has none, D65 [ColorInterop2026].
Chromaticity adoptedNeutral(OutputSpace);

// FilmParams as the renderer uses them.
struct FilmSettings {
    int width = 0, height = 0; // pixels
    PixelBounds overscan;      // the whole frame with what is seen beyond its edges
    PixelBounds crop;          // what is rendered; within that
    FilterShape filter = FilterShape::blackmanHarris;
    double filterRadius = 0; // pixels
    std::string output;      // path; empty: named after the scene
    OutputSpace space = OutputSpace::aces2065_1;
    std::string compression = "zip"; // as in the scene; a name of io/exr_writer.h
    bool half = false;
    bool parts = false; // each layer in a part of its own
    std::string sensor = "cie";
    std::optional<Chromaticity> adoptedWhite; // of the light that shall look neutral
    Matrix3 whiteBalance;       // on XYZ: takes that white to the space's neutral, by Bradford's transform
    bool acesContainer = false; // SMPTE ST 2065-4; then the three above are what that asks for
};

// A rule that the field table cannot express, broken by the value of `field`.
struct FilmFault {
    std::string_view field;
    std::string message; // one sentence, lower case
    std::string help;
    std::string_view code = "E0609";
};
std::vector<FilmFault> findFaults(const FilmParams&);

// Of the observer, or of a camera fitted for the light that shall look neutral, or else for D65.
// Both: require findFaults(params).empty().
Sensor makeSensor(const FilmParams&);
FilmSettings filmSettings(const FilmParams& params);

} // namespace abbe

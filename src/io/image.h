// Images in memory, reading them from files, and their colours on a display.
#pragma once

#include "spectrum/color_space.h"
#include "spectrum/xyz.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// The primaries and the white of an RGB encoding, as image headers state them.
struct Chromaticities {
    Chromaticity red, green, blue, white;

    static Chromaticities of(const RgbSpace& s) { return {s.red, s.green, s.blue, s.white}; }
    // Equal as far as the single precision of image headers can tell.
    bool matches(const RgbSpace&) const;
    // The space of this project that matches, or a nameless one.
    RgbSpace space() const;
};

// Half-open pixel rectangle; x to the right, y down.
struct PixelWindow {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    std::size_t area() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
    bool operator==(const PixelWindow&) const = default;
};

// Linear RGB, interleaved, row by row from the top left.
struct RgbImage {
    PixelWindow window;                           // the pixels that are stored
    PixelWindow display;                          // the whole picture; differs from `window` for crops
    std::vector<float> rgb;                       // 3 · window.area()
    std::optional<Chromaticities> chromaticities; // as the file states them
    std::optional<Chromaticity> adoptedNeutral;   // the colour that a display shall show neutral, if the file says so
    std::string interopId;                        // "lin_ap0_scene", as the file states it; empty: it does not
    std::uint64_t nonFinite = 0, negative = 0;    // texels with such a component, as found; they are left as they are

    int width() const { return window.width(); }
    int height() const { return window.height(); }
};

// No image with more pixels is read.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t(1) << 28;

// Sets `nonFinite` and `negative` from the pixels.
void countFaults(RgbImage&);

// OpenEXR (R G B, or Y alone for grey) or Radiance .hdr, told apart by content. Throws IoError.
RgbImage readImage(const std::string& path);

// Radiance .hdr (RGBE) input.
// Values are mantissa · 2^exponent as stored (no half step added, like nearly all writers and readers), divided by the
// EXPOSURE and COLORCORR of the header, which gives back what was there before them, as the format asks. PRIMARIES
// become the chromaticities. Rows in either order and columns in either order; XYZE and columns-first are refused.
// Throws IoError for damaged and truncated files.
RgbImage readHdr(const std::string& path);

// The colours of images as a display of our day would be sent them: linear Rec.709 with the white at D65.

// From the linear RGB of an image (Rec.709 if it names no primaries, as OpenEXR says) to linear Rec.709. What the image
// takes for white, its adopted neutral or else the white of its space, becomes D65 by Bradford's adaptation. Nothing is
// clipped: components may be negative.
Matrix3 toDisplayRgb(const RgbImage&);
// The same for two images of one space, of which only one may name it.
Matrix3 toDisplayRgb(const RgbImage& image, const RgbImage& reference);

} // namespace abbe

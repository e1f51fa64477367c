// Images in memory, and reading them from files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

// CIE xy of the primaries and the white of an RGB encoding.
struct Chromaticities {
    double redX = 0, redY = 0, greenX = 0, greenY = 0, blueX = 0, blueY = 0, whiteX = 0, whiteY = 0;

    // Equal as far as the single precision of image headers can tell.
    bool matches(const Chromaticities&) const;
};
inline constexpr Chromaticities kAp0Chromaticities{0.7347, 0.2653, 0, 1, 0.0001, -0.077, 0.32168, 0.33767};
inline constexpr Chromaticities kAp1Chromaticities{0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767};

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
    std::uint64_t nonFinite = 0, negative = 0;    // texels with such a component, as found; they are left as they are

    int width() const { return window.width(); }
    int height() const { return window.height(); }
};

// No image with more pixels is read.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t(1) << 28;

// OpenEXR (R G B, or Y alone for grey) or Radiance .hdr, told apart by content. Throws IoError.
RgbImage readImage(const std::string& path);

} // namespace abbe

// How pictures store colours: the primaries of a linear RGB space and a transfer curve.
#pragma once

#include "spectrum/color_space.h"

namespace abbe {

enum class TransferCurve : unsigned char { linear, srgb, gamma18, gamma22 };

// Named as the Color Interop Forum does, "srgb_rec709_scene".
struct ColorEncoding {
    std::string_view name;
    const RgbSpace* space = nullptr; // null: no colour but plain numbers ("data")
    TransferCurve curve = TransferCurve::linear;

    // The linear value of a stored one; odd-symmetric, 1 is exactly 1.
    double toLinear(double stored) const;
};

// By name or by what files and other programs call it, any case: "srgb", "ACEScg", "Gamma2.2", "raw", …; null for what
// is not known.
const ColorEncoding* findColorEncoding(std::string_view name);
// The linear encoding with these primaries and white, to 0.002; null if none has them.
const ColorEncoding* findColorEncoding(Chromaticity red, Chromaticity green, Chromaticity blue, Chromaticity white);
// The names proper, commonest first.
std::vector<std::string_view> colorEncodingNames();

} // namespace abbe

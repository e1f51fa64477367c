// Colour spaces: linear RGB, derived from the chromaticities of its primaries and white, the encodings of pictures, and
// CIELAB.
#pragma once

#include "math/vec.h"
#include "spectrum/xyz.h"

#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

// CIE 1931 x, y.
struct Chromaticity {
    double x = 0, y = 0;
};
Chromaticity chromaticity(const Xyz&);
// The XYZ of a white with Y = 1. Requires y > 0.
Xyz whiteXyz(Chromaticity);

// A linear RGB space. RGB (1, 1, 1) is its white with Y = 1. No chromatic adaptation happens on conversion: colours
// keep their chromaticity, so a D65 grey is bluish in a D60 space.
struct RgbSpace {
    std::string_view name; // identifier of the Color Interop Forum, "lin_rec709_scene"
    Chromaticity red, green, blue, white;
    std::string_view illuminant; // the named illuminant of that white

    Matrix3 toXyz() const;
    Matrix3 fromXyz() const { return toXyz().inverse(); }
};

namespace rgb {
extern const RgbSpace rec709;  // ITU-R BT.709, also sRGB (IEC 61966-2-1)
extern const RgbSpace rec2020; // ITU-R BT.2020
extern const RgbSpace p3d65;   // SMPTE EG 432-1 primaries with D65: Display P3
extern const RgbSpace ap1;     // ACEScg (Academy S-2014-004)
extern const RgbSpace ap0;     // ACES2065-1 (SMPTE ST 2065-1)
extern const RgbSpace xyz;     // CIE 1931 X, Y, Z in the places of R, G, B; (1, 1, 1) has equal energy
} // namespace rgb

// By identifier or alias, any case: "acescg", "srgb-linear", "aces2065-1", …
std::optional<RgbSpace> findRgbSpace(std::string_view name);
// Every name that findRgbSpace knows.
std::vector<std::string_view> rgbSpaceNames();

inline Vec3d toRgb(const Xyz& xyz, const RgbSpace& space) { return space.fromXyz().apply<Vec3d>(xyz); }
inline Xyz toXyz(const Vec3d& rgb, const RgbSpace& space) { return space.toXyz().apply<Xyz>(rgb); }

// sRGB's piecewise transfer function, odd-symmetric for negative values.
double srgbToLinear(double encoded);
double linearToSrgb(double linear);

enum class ConeModel { bradford, cat02 };
// The matrix on XYZ that takes colours seen under one white to corresponding colours under another (von Kries in the
// model's cone space). Only for declared uses: the film never applies it by itself.
Matrix3 adaptation(const Xyz& fromWhite, const Xyz& toWhite, ConeModel = ConeModel::bradford);

// What the cones of the eye answer to a colour, as models of chromatic adaptation have it.
// In the space in which adaptation() scales. Colours far from any white, those of single lines for example, have
// responses of 0 or below.
Vec3d coneResponse(const Xyz&, ConeModel = ConeModel::bradford);

// How pictures store colours: the primaries of a linear RGB space and a transfer curve.

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

// CIELAB and colour differences, for reports and tests.

// CIE 1976 L*, a*, b*.
struct Lab {
    double l = 0, a = 0, b = 0;
};

// Negative tristimulus values are allowed: the linear branch goes on.
Lab toLab(const Xyz&, const Xyz& white);

// Euclidean distance (CIE 1976).
double deltaE76(const Lab&, const Lab&);
// CIEDE2000 with kL = kC = kH = 1 [Sharma2005].
double deltaE2000(const Lab&, const Lab&);

} // namespace abbe

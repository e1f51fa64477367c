#include "spectrum/color_space.h"

#include "spectrum/cone_response.h"
#include "spectrum/names.h"

#include <cmath>
#include <iterator>

namespace abbe {

namespace {
constexpr Chromaticity kD65{0.3127, 0.3290};
constexpr Chromaticity kAcesWhite{0.32168, 0.33767};
} // namespace

const RgbSpace rgb::rec709{"lin_rec709_scene", {0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65, "D65"};
const RgbSpace rgb::rec2020{"lin_rec2020_scene", {0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65, "D65"};
const RgbSpace rgb::p3d65{"lin_p3d65_scene", {0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65, "D65"};
const RgbSpace rgb::ap1{"lin_ap1_scene", {0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, kAcesWhite, "D60"};
const RgbSpace rgb::ap0{"lin_ap0_scene", {0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, kAcesWhite, "D60"};
const RgbSpace rgb::xyz{"lin_ciexyzd65_scene", {1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}, "E"};

namespace {

struct NamedSpace {
    std::string_view alias;
    const RgbSpace* space;
};

constexpr NamedSpace kSpaces[] = {
    {"lin_rec709_scene", &rgb::rec709},
    {"srgb-linear", &rgb::rec709},
    {"rec709", &rgb::rec709},
    {"lin_rec2020_scene", &rgb::rec2020},
    {"rec2020", &rgb::rec2020},
    {"lin_p3d65_scene", &rgb::p3d65},
    {"p3-d65", &rgb::p3d65},
    {"lin_ap1_scene", &rgb::ap1},
    {"acescg", &rgb::ap1},
    {"ap1", &rgb::ap1},
    {"lin_ap0_scene", &rgb::ap0},
    {"aces2065-1", &rgb::ap0},
    {"ap0", &rgb::ap0},
};

} // namespace

Chromaticity chromaticity(const Xyz& c) {
    const double sum = c.x + c.y + c.z;
    return {c.x / sum, c.y / sum};
}

Xyz whiteXyz(Chromaticity c) { return {c.x / c.y, 1, (1 - c.x - c.y) / c.y}; }

Matrix3 RgbSpace::toXyz() const {
    // Columns are the primaries, scaled so that their sum is the white [SMPTE1993].
    const Matrix3 primaries{{{red.x, green.x, blue.x},
                             {red.y, green.y, blue.y},
                             {1 - red.x - red.y, 1 - green.x - green.y, 1 - blue.x - blue.y}}};
    const Vec3d scale = primaries.inverse().apply<Vec3d>(whiteXyz(white));
    return primaries * Matrix3::diagonal(scale.x, scale.y, scale.z);
}

std::optional<RgbSpace> findRgbSpace(std::string_view name) {
    for (const NamedSpace& s : kSpaces)
        if (sameName(s.alias, name)) return *s.space;
    return std::nullopt;
}

std::vector<std::string_view> rgbSpaceNames() {
    std::vector<std::string_view> names;
    for (const NamedSpace& s : kSpaces) names.push_back(s.alias);
    return names;
}

double srgbToLinear(double encoded) {
    const double a = std::abs(encoded);
    const double linear = a <= 0.04045 ? a / 12.92 : std::pow((a + 0.055) / 1.055, 2.4);
    return std::copysign(linear, encoded);
}

double linearToSrgb(double linear) {
    const double a = std::abs(linear);
    const double encoded = a <= 0.0031308 ? a * 12.92 : 1.055 * std::pow(a, 1 / 2.4) - 0.055;
    return std::copysign(encoded, linear);
}

namespace {
constexpr Matrix3 kBradford{{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
constexpr Matrix3 kCat02{{{0.7328, 0.4296, -0.1624}, {-0.7036, 1.6975, 0.0061}, {0.0030, 0.0136, 0.9834}}};

const Matrix3& toCones(ConeModel model) { return model == ConeModel::bradford ? kBradford : kCat02; }
} // namespace

Vec3d coneResponse(const Xyz& colour, ConeModel model) { return toCones(model).apply<Vec3d>(colour); }

Matrix3 adaptation(const Xyz& fromWhite, const Xyz& toWhite, ConeModel model) {
    const Vec3d from = coneResponse(fromWhite, model), to = coneResponse(toWhite, model);
    const Matrix3& cones = toCones(model);
    return cones.inverse() * Matrix3::diagonal(to.x / from.x, to.y / from.y, to.z / from.z) * cones;
}

} // namespace abbe

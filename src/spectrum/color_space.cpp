#include "spectrum/color_space.h"

#include "base/text.h"
#include "math/vec.h"

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

namespace {

// Adobe RGB (1998), section 4.3.
constexpr Chromaticity kD65White{0.3127, 0.3290};
const RgbSpace kAdobeRgb{"lin_adobergb_scene", {0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, kD65White, "D65"};

struct Entry {
    ColorEncoding encoding;
    std::vector<std::string_view> aliases;
};

const std::vector<Entry>& entries() {
    using enum TransferCurve;
    static const std::vector<Entry> all = {
        {{"srgb_rec709_scene", &rgb::rec709, srgb}, {"srgb", "srgb_texture", "srgb - texture", "srgb_tx"}},
        {{"lin_rec709_scene", &rgb::rec709, linear},
         {"linear", "lin_srgb", "srgb-linear", "scene_linear", "rec709", "lin_rec709", "linear rec.709 (srgb)"}},
        {{"data", nullptr, linear}, {"raw", "utility - raw"}},
        {{"lin_ap1_scene", &rgb::ap1, linear}, {"acescg", "ap1", "lin_ap1"}},
        {{"lin_ap0_scene", &rgb::ap0, linear}, {"aces2065-1", "ap0", "lin_ap0"}},
        {{"lin_rec2020_scene", &rgb::rec2020, linear}, {"rec2020", "lin_rec2020", "linear rec.2020"}},
        {{"lin_p3d65_scene", &rgb::p3d65, linear}, {"p3-d65", "lin_p3d65", "linear p3-d65"}},
        {{"lin_adobergb_scene", &kAdobeRgb, linear}, {"lin_adobergb"}},
        {{"srgb_p3d65_scene", &rgb::p3d65, srgb}, {"display-p3", "srgb_p3d65"}},
        {{"srgb_ap1_scene", &rgb::ap1, srgb}, {"srgb_ap1"}},
        {{"g18_rec709_scene", &rgb::rec709, gamma18}, {"gamma1.8", "g18_rec709"}},
        {{"g22_rec709_scene", &rgb::rec709, gamma22}, {"gamma2.2", "g22_rec709"}},
        {{"g22_ap1_scene", &rgb::ap1, gamma22}, {"g22_ap1"}},
        {{"g22_adobergb_scene", &kAdobeRgb, gamma22}, {"adobergb", "g22_adobergb"}},
    };
    return all;
}

bool near(Chromaticity a, Chromaticity b) { return std::abs(a.x - b.x) < 0.002 && std::abs(a.y - b.y) < 0.002; }

} // namespace

double ColorEncoding::toLinear(double stored) const {
    switch (curve) {
    case TransferCurve::linear:
        return stored;
    case TransferCurve::srgb:
        return srgbToLinear(stored);
    case TransferCurve::gamma18:
        return std::copysign(std::pow(std::abs(stored), 1.8), stored);
    case TransferCurve::gamma22:
        return std::copysign(std::pow(std::abs(stored), 2.2), stored);
    }
    return stored;
}

const ColorEncoding* findColorEncoding(std::string_view name) {
    for (const Entry& e : entries()) {
        if (sameName(e.encoding.name, name)) return &e.encoding;
        for (const std::string_view alias : e.aliases)
            if (sameName(alias, name)) return &e.encoding;
    }
    return nullptr;
}

const ColorEncoding* findColorEncoding(Chromaticity red, Chromaticity green, Chromaticity blue, Chromaticity white) {
    for (const Entry& e : entries()) {
        const RgbSpace* const s = e.encoding.space;
        if (s && e.encoding.curve == TransferCurve::linear && near(s->red, red) && near(s->green, green) &&
            near(s->blue, blue) && near(s->white, white))
            return &e.encoding;
    }
    return nullptr;
}

std::vector<std::string_view> colorEncodingNames() {
    std::vector<std::string_view> names;
    for (const Entry& e : entries()) names.push_back(e.encoding.name);
    return names;
}

namespace {

double labCurve(double t) {
    constexpr double d = 6.0 / 29;
    return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

constexpr double radians(double degrees) { return degrees * (kPiD / 180); }

// Hue angle in [0, 360).
double hue(double a, double b) {
    if (a == 0 && b == 0) return 0;
    const double h = std::atan2(b, a) * (180 / kPiD);
    return h < 0 ? h + 360 : h;
}

double power7(double x) { return x * x * x * x * x * x * x; }

} // namespace

Lab toLab(const Xyz& c, const Xyz& white) {
    const double x = labCurve(c.x / white.x), y = labCurve(c.y / white.y), z = labCurve(c.z / white.z);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double deltaE76(const Lab& p, const Lab& q) {
    return std::sqrt(square(p.l - q.l) + square(p.a - q.a) + square(p.b - q.b));
}

// [Sharma2005, eq. 2 to 22], symbols as there.
double deltaE2000(const Lab& p, const Lab& q) {
    constexpr double twentyFive7 = 6103515625.0; // 25⁷
    const double meanC = 0.5 * (std::hypot(p.a, p.b) + std::hypot(q.a, q.b));
    const double g = 0.5 * (1 - std::sqrt(power7(meanC) / (power7(meanC) + twentyFive7)));
    const double a1 = (1 + g) * p.a, a2 = (1 + g) * q.a;
    const double c1 = std::hypot(a1, p.b), c2 = std::hypot(a2, q.b);
    const double h1 = hue(a1, p.b), h2 = hue(a2, q.b);

    double dh = h2 - h1, meanH = 0.5 * (h1 + h2);
    if (c1 * c2 == 0) {
        dh = 0;
        meanH = h1 + h2;
    } else if (std::abs(dh) > 180) {
        dh += dh > 0 ? -360 : 360;
        meanH += h1 + h2 < 360 ? 180 : -180;
    }
    const double dL = q.l - p.l, dC = c2 - c1;
    const double dH = 2 * std::sqrt(c1 * c2) * std::sin(radians(0.5 * dh));

    const double l = 0.5 * (p.l + q.l), c = 0.5 * (c1 + c2);
    const double t = 1 - 0.17 * std::cos(radians(meanH - 30)) + 0.24 * std::cos(radians(2 * meanH)) +
                     0.32 * std::cos(radians(3 * meanH + 6)) - 0.20 * std::cos(radians(4 * meanH - 63));
    const double sl = 1 + 0.015 * square(l - 50) / std::sqrt(20 + square(l - 50));
    const double sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
    const double rotation = 60 * std::exp(-square((meanH - 275) / 25));
    const double rt = -std::sin(radians(rotation)) * 2 * std::sqrt(power7(c) / (power7(c) + twentyFive7));
    return std::sqrt(square(dL / sl) + square(dC / sc) + square(dH / sh) + rt * (dC / sc) * (dH / sh));
}

} // namespace abbe

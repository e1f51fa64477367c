#include "spectrum/color_encoding.h"

#include "spectrum/names.h"

#include <cmath>

namespace abbe {

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

} // namespace abbe

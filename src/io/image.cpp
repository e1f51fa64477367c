#include "io/image.h"

#include "base/file.h"
#include "io/array_geometry.h"
#include "io/exr_reader.h"
#include "io/file.h"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace abbe {

bool Chromaticities::matches(const RgbSpace& space) const {
    const auto near = [](Chromaticity a, Chromaticity b) {
        return std::abs(a.x - b.x) < 1e-5 && std::abs(a.y - b.y) < 1e-5;
    };
    return near(red, space.red) && near(green, space.green) && near(blue, space.blue) && near(white, space.white);
}

RgbSpace Chromaticities::space() const {
    for (const RgbSpace* known : {&rgb::rec709, &rgb::ap1, &rgb::ap0, &rgb::rec2020, &rgb::p3d65, &rgb::xyz})
        if (matches(*known)) return *known;
    return {"", red, green, blue, white, ""};
}

void countFaults(RgbImage& image) {
    image.nonFinite = image.negative = 0;
    for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
        const float r = image.rgb[i], g = image.rgb[i + 1], b = image.rgb[i + 2];
        image.nonFinite += !(std::isfinite(r) && std::isfinite(g) && std::isfinite(b));
        image.negative += r < 0 || g < 0 || b < 0;
    }
}

RgbImage readImage(const std::string& path) {
    if (const auto arrays = findArrays(path)) return imageOf(*arrays, path);
    std::array<char, 4> magic{};
    RegularFile file(path);
    const std::size_t got = file.readAt(0, magic);
    if (!file.good()) throw IoError(fmt::format("cannot read `{}`: {}", path, file.why()));
    if (got != magic.size()) throw IoError(fmt::format("cannot read `{}`: it is cut short", path));
    const std::string_view start(magic.data(), magic.size());
    if (start == std::string_view("\x76\x2f\x31\x01", 4)) return readExr(path);
    if (start.substr(0, 2) == "#?") return readHdr(path);
    throw IoError(fmt::format("cannot read `{}`: it is neither OpenEXR nor Radiance HDR", path));
}

Matrix3 toDisplayRgb(const RgbImage& image) {
    if (!image.chromaticities) return {};
    const RgbSpace space = image.chromaticities->space();
    const bool neutral = image.adoptedNeutral && image.adoptedNeutral->y > 0;
    const Chromaticity white = neutral ? *image.adoptedNeutral : space.white;
    return rgb::rec709.fromXyz() * adaptation(whiteXyz(white), whiteXyz(rgb::rec709.white)) * space.toXyz();
}

Matrix3 toDisplayRgb(const RgbImage& image, const RgbImage& reference) {
    return toDisplayRgb(reference.chromaticities ? reference : image);
}

} // namespace abbe

#include "pictures/compare_images.h"

#include "base/check.h"
#include "io/exr_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

namespace abbe {

namespace {

bool isExr(const std::string& path) {
    constexpr char kExrMagic[4] = {0x76, 0x2f, 0x31, 0x01};
    char bytes[4] = {};
    std::ifstream file(path, std::ios::binary);
    return file.read(bytes, 4) && std::equal(bytes, bytes + 4, kExrMagic);
}

int replicatesOf(const ExrInfo& info) {
    for (const ImageAttribute& attribute : info.attributes)
        if (attribute.name == "abbe.replicates")
            if (const auto* value = std::get_if<std::int32_t>(&attribute.value)) return std::max(2, *value);
    return 2;
}

} // namespace

CompareImage CompareImage::read(const std::string& path) {
    CompareImage image;
    image.path = path;
    image.picture = readImage(path);
    // A sum of floats is as exact as its terms; a few units in the last place come from the arithmetic of the film.
    image.rounding = 0x1p-22;
    if (!isExr(path)) return image;
    const ExrInfo info = readExrInfo(path);
    for (const ExrInfo::Channel& channel : info.channels) {
        if (channel.type == "half" && channel.name != "variance.Y") image.rounding = 0x1p-11;
        if (channel.name == "variance.Y") image.variance = readExrChannel(path, channel.name);
    }
    image.replicates = replicatesOf(info);
    return image;
}

CompareImage CompareImage::mean(std::span<const CompareImage> images) {
    ABBE_CHECK(!images.empty());
    CompareImage result = images[0];
    const auto n = static_cast<float>(images.size());
    for (const CompareImage& image : images.subspan(1)) {
        for (std::size_t i = 0; i < result.picture.rgb.size(); ++i) result.picture.rgb[i] += image.picture.rgb[i];
        if (image.variance.empty()) result.variance.clear();
        for (std::size_t i = 0; i < result.variance.size(); ++i) result.variance[i] += image.variance[i];
        result.replicates = std::min(result.replicates, image.replicates);
        result.rounding = std::max(result.rounding, image.rounding);
        result.path += ", " + image.path;
    }
    for (float& v : result.picture.rgb) v /= n;
    for (float& v : result.variance) v /= n * n;
    return result;
}

std::vector<float> CompareImage::luminance() const {
    const Matrix3 m = (picture.chromaticities ? picture.chromaticities->space() : rgb::rec709).toXyz();
    std::vector<float> y(picture.rgb.size() / 3);
    for (std::size_t i = 0; i < y.size(); ++i)
        y[i] = static_cast<float>(m.m[1][0] * picture.rgb[3 * i] + m.m[1][1] * picture.rgb[3 * i + 1] +
                                  m.m[1][2] * picture.rgb[3 * i + 2]);
    return y;
}

std::optional<TileTest> tileTest(const CompareImage& image, const CompareImage& reference) {
    if (image.variance.empty() || reference.variance.empty()) return std::nullopt;
    const std::vector<float> a = image.luminance(), b = reference.luminance();
    return tileTest({a, image.variance, image.replicates, image.rounding},
                    {b, reference.variance, reference.replicates, reference.rounding}, image.picture.width(),
                    image.picture.height());
}

} // namespace abbe

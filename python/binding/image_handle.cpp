#include "binding/image_handle.h"

#include "io/exr_reader.h"
#include "io/file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace abbe::python {

namespace {

constexpr std::array kSpaces = {OutputSpace::aces2065_1, OutputSpace::acescg, OutputSpace::rec709, OutputSpace::xyz};

OutputSpace spaceOf(const ExrInfo& info, const std::string& path) {
    // Without chromaticities OpenEXR means Rec.709.
    if (!info.chromaticities) return OutputSpace::rec709;
    const auto* const found =
        std::ranges::find_if(kSpaces, [&](OutputSpace s) { return info.chromaticities->matches(rgbSpace(s)); });
    if (found == kSpaces.end())
        throw IoError(fmt::format("`{}` has primaries that are none of ACES2065-1, ACEScg, Rec.709 and XYZ", path));
    return *found;
}

} // namespace

ImageHandle ImageHandle::read(const std::string& path) {
    ExrPlanes planes = readExrChannels(path);
    const ExrInfo& info = planes.info;
    HeldImage held;
    held.image.bounds = {info.window.x0, info.window.y0, info.window.x1, info.window.y1};
    held.film.width = info.display.width();
    held.film.height = info.display.height();
    held.film.space = spaceOf(info, path);
    held.film.compression = findExrCompression(info.compression) ? info.compression : "zip";
    held.film.half = false;
    held.film.parts = info.parts > 1;
    for (const ImageAttribute& a : info.attributes) // OpenEXR's own follow from the rest
        if (a.name.starts_with("abbe.") || a.name.starts_with("cryptomatte/") || a.name == "colorInteropID")
            held.attributes.push_back(a);
    bool colour = true;
    for (std::size_t i = 0; i < info.channels.size(); ++i) {
        const std::string& name = info.channels[i].name;
        std::vector<float>& values = planes.values[i];
        if (name == "R")
            held.image.r = std::move(values);
        else if (name == "G")
            held.image.g = std::move(values);
        else if (name == "B")
            held.image.b = std::move(values);
        else if (name == "variance.Y")
            held.image.variance = std::move(values);
        else
            held.layers.push_back({name, std::move(values)});
        if (name == "R") held.film.half = info.channels[i].type == "half";
    }
    for (const auto* plane : {&held.image.r, &held.image.g, &held.image.b}) colour = colour && !plane->empty();
    if (!colour) throw IoError(fmt::format("`{}` has no channels R, G and B, but {}", path, info.channelNames()));
    return ImageHandle(std::make_shared<const HeldImage>(std::move(held)));
}

std::vector<std::string> ImageHandle::channels() const {
    std::vector<std::string> names{"R", "G", "B"};
    if (!image_->image.variance.empty()) names.emplace_back("variance.Y");
    for (const NamedPlane& layer : image_->layers) names.push_back(layer.name);
    return names;
}

std::span<const float> ImageHandle::plane(std::string_view channel) const {
    const ResolvedImage& image = image_->image;
    if (channel == "R") return image.r;
    if (channel == "G") return image.g;
    if (channel == "B") return image.b;
    if (channel == "variance.Y") return image.variance;
    const auto found = std::ranges::find(image_->layers, channel, &NamedPlane::name);
    return found == image_->layers.end() ? std::span<const float>() : std::span<const float>(found->values);
}

std::vector<float> ImageHandle::rgb(const RgbSpace& space) const {
    const ResolvedImage& image = image_->image;
    const RgbSpace& own = rgbSpace(image_->film.space);
    const bool same = own.name == space.name;
    const Matrix3 toSpace = space.fromXyz(), toXyz = own.toXyz();
    std::vector<float> values(3 * image.r.size());
    for (std::size_t i = 0; i < image.r.size(); ++i) {
        float* const out = &values[3 * i];
        if (same) {
            out[0] = image.r[i], out[1] = image.g[i], out[2] = image.b[i];
            continue;
        }
        const Vec3d rgb{static_cast<double>(image.r[i]), static_cast<double>(image.g[i]),
                        static_cast<double>(image.b[i])};
        const auto converted = toSpace.apply<Vec3d>(toXyz.apply<Vec3d>(rgb));
        out[0] = static_cast<float>(converted.x);
        out[1] = static_cast<float>(converted.y);
        out[2] = static_cast<float>(converted.z);
    }
    return values;
}

void ImageHandle::savePng(const std::string& path, const ViewOptions& view, int bits) const {
    const PixelBounds& b = image_->image.bounds;
    DisplayPicture picture{width(), height(), rgb(rgbSpace(image_->film.space)), image_->film.space};
    cutOut(picture, {b.x0, b.y0, b.x1, b.y1}, {0, 0, image_->film.width, image_->film.height});
    writeDisplayPng(path, std::move(picture), view, bits);
}

void ImageHandle::save(const std::string& path, const ViewOptions& view, int bits, DiagnosticLog& log) const {
    if (isPngName(path)) return savePng(path, view, bits);
    if (std::filesystem::path(path).extension() != ".exr")
        throw IoError(fmt::format("cannot write `{}`: images are `.exr`, or `.png` to look at", path));
    Diagnostics found;
    writeImage(path, *image_, found);
    log.add(found, SourceMap());
}

} // namespace abbe::python

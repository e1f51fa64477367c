#include "io/exr_reader.h"

#include "base/memory_limit.h"
#include "io/io_error.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace abbe {

RgbImage readExr(const std::string& path) {
    constexpr std::array<std::string_view, 4> kNames{"R", "G", "B", "Y"};
    const ExrPlanes planes = readExrChannels(
        path, [&](std::string_view name) { return std::find(kNames.begin(), kNames.end(), name) != kNames.end(); });
    std::array<const std::vector<float>*, 3> sources{planes.find("R"), planes.find("G"), planes.find("B")};
    if (!sources[0] || !sources[1] || !sources[2]) {
        // Beside RY and BY, Y is no grey but the luminance of a picture in other channels.
        sources.fill(planes.info.has("RY") ? nullptr : planes.find("Y"));
        if (!sources[0])
            throw IoError(fmt::format("cannot read `{}`: it has neither the channels R G B nor Y alone, but {}", path,
                                      planes.info.channelNames()));
    }
    RgbImage image;
    image.window = planes.info.window;
    image.display = planes.info.display;
    image.chromaticities = planes.info.chromaticities;
    image.adoptedNeutral = planes.info.adoptedNeutral;
    for (const ImageAttribute& a : planes.info.attributes)
        if (const auto* text = std::get_if<std::string>(&a.value); text && a.name == "colorInteropID")
            image.interopId = *text;
    requireMemory(static_cast<double>(image.window.area()) * 3 * sizeof(float));
    image.rgb.resize(3 * image.window.area());
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = (*sources[i % 3])[i / 3];
    countFaults(image);
    return image;
}

} // namespace abbe

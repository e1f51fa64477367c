// Environment images for tests.
#pragma once

#include "io/exr_writer.h"

#include <array>
#include <string>
#include <vector>

namespace abbe::test {

// Rec. 709, linear; `color(x, y)` gives R, G and B of a texel, rows from the zenith down.
template <typename F> void writeEnvironment(const std::string& path, int width, int height, F&& color) {
    std::array<std::vector<float>, 3> planes;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::array<float, 3> c = color(x, y);
            for (std::size_t i = 0; i < 3; ++i) planes[i].push_back(c[i]);
        }
    const PixelWindow window{0, 0, width, height};
    writeExr(path, {.window = window,
                    .display = window,
                    .r = planes[0],
                    .g = planes[1],
                    .b = planes[2],
                    .chromaticities = Chromaticities::of(rgb::rec709)});
}

} // namespace abbe::test

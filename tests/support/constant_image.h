// A picture of one colour.
#pragma once

#include "io/image.h"
#include "math/vec.h"

namespace abbe::test {

inline RgbImage constant(int width, int height, const Vec3d& value) {
    RgbImage image;
    image.window = image.display = {0, 0, width, height};
    for (std::size_t i = 0; i < image.window.area(); ++i)
        for (const double v : {value.x, value.y, value.z}) image.rgb.push_back(static_cast<float>(v));
    return image;
}

} // namespace abbe::test

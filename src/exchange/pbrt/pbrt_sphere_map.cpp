#include "exchange/pbrt/pbrt_sphere_map.h"

#include <algorithm>
#include <cmath>

namespace abbe::exchange {

// One octant is a right triangle of the square: r = √(1 - |z|) is the distance from its corner, and the angle about the
// axis runs evenly along its hypotenuse.
Vec2d pbrtSphereToSquare(Vec3d d) {
    const double x = std::abs(d.x), y = std::abs(d.y), r = std::sqrt(std::max(0.0, 1 - std::abs(d.z)));
    const double phi = std::atan2(y, x) * 2 / kPiD;
    double v = phi * r, u = r - v;
    if (d.z < 0) { // the outer half, mirrored at the hypotenuse
        const double swapped = u;
        u = 1 - v;
        v = 1 - swapped;
    }
    return {(std::copysign(u, d.x) + 1) / 2, (std::copysign(v, d.y) + 1) / 2};
}

Vec3d pbrtSquareToSphere(Vec2d square) {
    const double u = 2 * square.x - 1, v = 2 * square.y - 1, x = std::abs(u), y = std::abs(v);
    const double signedDistance = 1 - (x + y), d = std::abs(signedDistance), r = 1 - d;
    const double phi = (r == 0 ? 1 : (y - x) / r + 1) * kPiD / 4;
    const double z = std::copysign(1 - r * r, signedDistance), s = r * std::sqrt(std::max(0.0, 2 - r * r));
    return {std::copysign(std::cos(phi) * s, u), std::copysign(std::sin(phi) * s, v), z};
}

Vec3d pbrtOctahedralLookup(const RgbImage& image, Vec2d square) {
    const int size = image.width();
    const auto texel = [&](int x, int y) {
        if (x < 0 || x >= size) {
            x = std::clamp(x, 0, size - 1);
            y = size - 1 - y;
        }
        if (y < 0 || y >= size) {
            y = std::clamp(y, 0, size - 1);
            x = size - 1 - x;
        }
        const float* rgb = image.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
                                                   static_cast<std::size_t>(x));
        return Vec3d(Vec3(rgb[0], rgb[1], rgb[2]));
    };
    const double px = square.x * size - 0.5, py = square.y * size - 0.5;
    const int x = static_cast<int>(std::floor(px)), y = static_cast<int>(std::floor(py));
    const double fx = px - x, fy = py - y;
    return (texel(x, y) * (1 - fx) + texel(x + 1, y) * fx) * (1 - fy) +
           (texel(x, y + 1) * (1 - fx) + texel(x + 1, y + 1) * fx) * fy;
}

} // namespace abbe::exchange

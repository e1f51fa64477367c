#include "exchange/shared/preview.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe::exchange {

namespace {

constexpr int kPreviewWidth = 960, kPreviewHeight = 720; // pixels
constexpr double kPreviewFov = 35;                       // degrees across the width, that of a short telephoto lens
constexpr double kPreviewFilled = 0.9;                   // of the frame, by the box
// Degrees, of the camera: from +z towards +x, and upwards.
constexpr double kPreviewAzimuth = 30, kPreviewElevation = 22;

Bounds3d previewBox(Bounds3d box) {
    if (box.empty()) box = {{0, 0, 0}, {0, 0, 0}};
    if (box.radius() > 0) return box;
    const Vec3d half(0.5, 0.5, 0.5);
    return {box.lower - half, box.upper + half};
}

// Four digits of what is as long as `scale`: nobody wants to read more.
Vec3d previewRounded(const Vec3d& v, double scale) {
    const double digits = 3 - std::floor(std::log10(scale)), power = std::pow(10.0, std::abs(digits));
    const auto coordinate = [&](double x) { // + 0: no −0
        return (digits < 0 ? std::round(x / power) * power : std::round(x * power) / power) + 0.0;
    };
    return {coordinate(v.x), coordinate(v.y), coordinate(v.z)};
}

// A box about the origin in the axes of a camera that looks along −z.
struct PreviewCorners {
    std::array<Vec3d, 8> at;

    // The least distance at which the box is no wider than the frame, for the tangent t of half of it. Seen from
    // (c, d) a corner is inside if |x − c| ≤ (d − z) t; those that lie farthest out to either side tell d.
    double distance(int axis, double t) const {
        double below = 0, above = 0;
        for (const Vec3d& p : at) {
            below = std::max(below, p.z * t - p[axis]);
            above = std::max(above, p.z * t + p[axis]);
        }
        return (below + above) / (2 * t);
    }
    // Where the camera stands at that distance or farther, so that there is as much room on either side: by bisection.
    double middle(int axis, double distance) const {
        double low = 0, high = 0;
        for (const Vec3d& p : at) {
            low = std::min(low, p[axis]);
            high = std::max(high, p[axis]);
        }
        for (int step = 0; step < 60; ++step) {
            const double c = (low + high) / 2;
            double below = 0, above = 0;
            for (const Vec3d& p : at) {
                below = std::max(below, (c - p[axis]) / (distance - p.z));
                above = std::max(above, (p[axis] - c) / (distance - p.z));
            }
            (above > below ? low : high) = c;
        }
        return (low + high) / 2;
    }
};

} // namespace

SceneNode previewFilm() {
    SceneNode film("film");
    film.child("size").number(kPreviewWidth).number(kPreviewHeight);
    return film;
}

SceneNode previewCamera(const Bounds3d& bounds) {
    const Bounds3d box = previewBox(bounds);
    const double azimuth = kPreviewAzimuth * kDegree, elevation = kPreviewElevation * kDegree;
    const Vec3d back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                     std::cos(azimuth) * std::cos(elevation));
    const Vec3d right = normalize(cross(Vec3d(0, 1, 0), back)), up = cross(back, right);
    PreviewCorners corners;
    for (std::size_t i = 0; i < 8; ++i) {
        const Vec3d half = box.diagonal() * 0.5;
        const Vec3d p(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
        corners.at[i] = {dot(p, right), dot(p, up), dot(p, back)};
    }
    const double across = kPreviewFilled * std::tan(kPreviewFov * kDegree / 2);
    const double distance =
        std::max(corners.distance(0, across), corners.distance(1, across * kPreviewHeight / kPreviewWidth));
    const Vec3d target = box.centre() + right * corners.middle(0, distance) + up * corners.middle(1, distance);
    SceneNode camera("camera");
    camera.word("perspective");
    camera.child("from").vector(previewRounded(target + back * distance, distance));
    camera.child("look-at").vector(previewRounded(target, distance));
    camera.child("fov").number(kPreviewFov).word("deg");
    return camera;
}

// Without an exposure 72 983 nits render as 1 (docs/output.md): white of 80 % in the key light of 150 klx as
// 0.8 (18 000 + 150 000/π) / 72 983 = 0.72, in its shadow as a quarter of that.
std::vector<SceneNode> previewLights() {
    SceneNode sky("light"), key("light");
    sky.name("surroundings").word("sky").child("luminance").number(18000).word("nits");
    key.name("key").word("sun").child("toward").vector({0.5, -1, -0.7});
    key.child("irradiance").number(150).word("klx");
    key.child("angular-diameter").number(20).word("deg");
    std::vector<SceneNode> lights;
    lights.push_back(std::move(sky));
    lights.push_back(std::move(key));
    return lights;
}

} // namespace abbe::exchange

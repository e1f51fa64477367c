// A model without a camera: all of it in the frame, and as large as that allows.
#include "exchange/shared/preview.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <sstream>
#include <string>
#include <vector>

using namespace abbe;
using namespace abbe::exchange;

namespace {

const SceneNode& childOf(const SceneNode& node, const std::string& name) {
    const auto found = std::ranges::find(node.children(), name, &SceneNode::kind);
    REQUIRE(found != node.children().end());
    return *found;
}

// The numbers that a property begins with.
std::vector<double> numbersOf(const SceneNode& node, const std::string& name) {
    std::istringstream text{std::string(childOf(node, name).values())};
    std::vector<double> list;
    for (double value = 0; text >> value;) list.push_back(value);
    return list;
}

Vec3d vectorOf(const SceneNode& node, const std::string& name) {
    const auto values = numbersOf(node, name);
    REQUIRE(values.size() == 3);
    return {values[0], values[1], values[2]};
}

// Where the corners of a box are in the frame: from −1 to 1 both ways. They are in front of the camera.
struct Framing {
    double left = 1e9, right = -1e9, low = 1e9, high = -1e9;
};

Framing framingOf(const Bounds3d& box) {
    const SceneNode camera = previewCamera(box), film = previewFilm();
    const Vec3d from = vectorOf(camera, "from"), back = normalize(from - vectorOf(camera, "look-at"));
    const Vec3d right = normalize(cross(Vec3d(0, 1, 0), back)), up = cross(back, right);
    const double across = std::tan(numbersOf(camera, "fov").at(0) * kDegree / 2);
    const auto size = numbersOf(film, "size");
    const double aspect = size.at(0) / size.at(1);
    Framing f;
    for (int i = 0; i < 8; ++i) {
        const Vec3d p = Vec3d(i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y,
                              i & 4 ? box.upper.z : box.lower.z) -
                        from;
        const double depth = -dot(p, back);
        REQUIRE(depth > 0);
        const double x = dot(p, right) / (depth * across), y = dot(p, up) / (depth * across) * aspect;
        f = {std::min(f.left, x), std::max(f.right, x), std::min(f.low, y), std::max(f.high, y)};
    }
    return f;
}

} // namespace

TEST_CASE("the whole of a box is in the frame, and fills it one way") {
    for (const double scale : {1e-3, 0.07, 1.0, 33.0, 1e4})
        for (const Vec3d& size : {Vec3d(1, 1, 1), Vec3d(5, 1, 1), Vec3d(1, 9, 1), Vec3d(1, 1, 20), Vec3d(1, 0, 1),
                                  Vec3d(0, 1, 1), Vec3d(1, 1, 0), Vec3d(0, 1, 0)})
            for (const Vec3d& middle : {Vec3d(0, 0, 0), Vec3d(-40, 3, 700)}) {
                const Vec3d half = size * (scale / 2), centre = middle * scale;
                const Framing f = framingOf({centre - half, centre + half});
                CHECK(std::max({-f.left, f.right, -f.low, f.high}) == doctest::Approx(0.9).epsilon(0.01));
                CHECK(f.left + f.right == doctest::Approx(0).epsilon(0.01));
                CHECK(f.low + f.high == doctest::Approx(0).epsilon(0.01));
            }
}

TEST_CASE("a box without extent, or none at all, is looked at from a distance") {
    CHECK(printScene(std::list{previewCamera(Bounds3d{})}) ==
          printScene(std::list{previewCamera({{0, 0, 0}, {0, 0, 0}})}));
    const SceneNode camera = previewCamera({{7, 7, 7}, {7, 7, 7}});
    CHECK(length(vectorOf(camera, "from") - Vec3d(7, 7, 7)) > 1);
    CHECK(length(vectorOf(camera, "look-at") - Vec3d(7, 7, 7)) < 0.2);
}

TEST_CASE("a preview is seen from the front, in light from above") {
    const Vec3d from = vectorOf(previewCamera({{-1, -1, -1}, {1, 1, 1}}), "from");
    CHECK(from.z > from.x);
    CHECK(from.x > 0);
    CHECK(from.y > 0);
    CHECK(printScene(previewLights()) ==
          "light surroundings sky { luminance 18000 nits }\n"
          "light key sun { toward 0.5 -1 -0.7; irradiance 150 klx; angular-diameter 20 deg }\n");
}

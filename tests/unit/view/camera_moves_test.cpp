// Moves of a camera: what stays, what does not, and the lines that say where it came to.
#include "view/camera_moves.h"

#include <doctest/doctest.h>
#include <sstream>

namespace abbe {
namespace {

const CameraPose kSomewhere{{3, 2, 5}, {1, 0.5, -1}, {0, 1, 0}, 1};

double distanceOf(const CameraPose& p) { return length(p.lookAt - p.from); }
Vec3d aheadOf(const CameraPose& p) { return normalize(p.lookAt - p.from); }
// How far the picture's right is from level: the sine of the roll.
double rollOf(const CameraPose& p, Vec3d up) { return dot(normalize(cross(aheadOf(p), p.up)), up); }

TEST_CASE("orbiting keeps the distance, the look-at point and the horizon, however often") {
    CameraPose p = kSomewhere;
    for (int i = 0; i < 10000; ++i) p = orbited(p, {0.37 * std::sin(i * 0.7), 0.21 * std::cos(i * 1.3)});
    CHECK(p.lookAt == kSomewhere.lookAt);
    CHECK(p.up == kSomewhere.up);
    CHECK(distanceOf(p) == doctest::Approx(distanceOf(kSomewhere)).epsilon(1e-9));
    CHECK(std::abs(rollOf(p, {0, 1, 0})) < 1e-9);
}

TEST_CASE("orbiting to the right moves the camera to the right, upwards upwards, and never over the pole") {
    const CameraPose front{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 1};
    CHECK(orbited(front, {0.1, 0}).from.x == doctest::Approx(5 * std::sin(0.1)));
    CHECK(orbited(front, {0, 0.1}).from.y == doctest::Approx(5 * std::sin(0.1)));
    const CameraPose above = orbited(front, {0, 50});
    CHECK(above.from.y == doctest::Approx(5).epsilon(1e-5));
    CHECK(above.from.z > 0); // short of the pole, on its own side
    CHECK(Transform::lookAt(above.from, above.lookAt, above.up).has_value());
    const CameraPose back = orbited(above, {0, -50});
    CHECK(back.from.y == doctest::Approx(-5).epsilon(1e-5));
    // There and back again.
    CHECK(length(orbited(orbited(kSomewhere, {0.3, 0.2}), {-0.3, -0.2}).from - kSomewhere.from) < 1e-12);
}

TEST_CASE("a camera that is upright along z stays so") {
    CameraPose p{{4, -3, 2}, {0, 0, 1}, {0, 0, 1}, 1};
    for (int i = 0; i < 500; ++i) p = flown(panned(orbited(p, {0.3, -0.1}), {0.2, 0.1}, 2), {0.1, 0, 0.2});
    CHECK(std::abs(rollOf(p, {0, 0, 1})) < 1e-9);
}

TEST_CASE("looking around keeps the camera, panning the direction, a dolly the line") {
    const CameraPose around = lookedAround(kSomewhere, {0.4, 0.2});
    CHECK(around.from == kSomewhere.from);
    CHECK(distanceOf(around) == doctest::Approx(distanceOf(kSomewhere)));
    CHECK(dot(aheadOf(around), normalize(cross(aheadOf(kSomewhere), {0, 1, 0}))) > 0); // to the right
    CHECK(aheadOf(around).y > aheadOf(kSomewhere).y);

    const CameraPose pan = panned(kSomewhere, {0.5, -0.25}, 3);
    CHECK(length(aheadOf(pan) - aheadOf(kSomewhere)) < 1e-12);
    CHECK(length(pan.from - kSomewhere.from) == doctest::Approx(3 * std::hypot(0.5, 0.25)));
    CHECK(std::abs(dot(pan.from - kSomewhere.from, aheadOf(kSomewhere))) < 1e-12);

    const CameraPose near = dollied(kSomewhere, 0.5);
    CHECK(near.lookAt == kSomewhere.lookAt);
    CHECK(distanceOf(near) == doctest::Approx(0.5 * distanceOf(kSomewhere)));
    CHECK(length(aheadOf(near) - aheadOf(kSomewhere)) < 1e-12);
    CHECK(near.size == doctest::Approx(0.5));
    CameraPose nearest = kSomewhere; // never through what it looks at
    for (int i = 0; i < 2000; ++i) nearest = dollied(nearest, 0.01);
    CHECK(distanceOf(nearest) > 0);
    CHECK(length(aheadOf(nearest) - aheadOf(kSomewhere)) < 1e-6);

    const CameraPose fly = flown(kSomewhere, {0, 0, 1});
    CHECK(length(fly.from - kSomewhere.lookAt) < 1e-12);
}

TEST_CASE("the lines of a pose are in the scene's unit and as exact as the picture needs") {
    const CameraPose p{{0, 1, 4}, {0, 0.5, 0}, {0, 1, 0}, 1};
    CHECK(poseLines(p, 1, {0, 1, 0}) == "from 0 1 4\nlook-at 0 0.5 0");
    CHECK(poseLines(p, 0.01, {0, 1, 0}) == "from 0 100 400\nlook-at 0 50 0");
    CHECK(poseLines(p, 1, {0, 0, 1}) == "from 0 1 4\nlook-at 0 0.5 0\nup 0 1 0");
    const CameraPose odd = orbited(kSomewhere, {0.123456789, 0.1});
    std::istringstream lines(poseLines(odd, 1, {0, 1, 0}));
    std::string word;
    Vec3d from, lookAt;
    lines >> word >> from.x >> from.y >> from.z >> word >> lookAt.x >> lookAt.y >> lookAt.z;
    CHECK(length(from - odd.from) < 2e-6 * distanceOf(odd));
    CHECK(length(normalize(lookAt - from) - aheadOf(odd)) < 2e-6);
}

} // namespace
} // namespace abbe

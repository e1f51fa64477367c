#include "view/camera_moves.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr double kSteepest = 89.9 * kDegree;        // to the horizon: there `up` still has a direction in the picture
constexpr double kNearest = 1e-5, kFarthest = 1e12; // m, from what is looked at

struct PoseAxes {
    Vec3d right, up, ahead;
};

PoseAxes axesOf(const CameraPose& pose) {
    const Vec3d ahead = normalize(pose.lookAt - pose.from);
    const Vec3d right = normalize(cross(ahead, pose.up));
    return {right, cross(right, ahead), ahead};
}

Vec3d turned(Vec3d v, Vec3d axis, double radians) { return Transform::rotate(axis, radians).vector(v); }

// Turns `v` about `up`, and then towards it as far as kSteepest.
Vec3d turnedUpright(Vec3d v, Vec3d up, Vec2d radians) {
    const Vec3d upright = normalize(up);
    const double distance = length(v), height = dot(v, upright);
    const Vec3d level = v - upright * height;
    const double before = std::asin(std::clamp(height / distance, -1.0, 1.0));
    const double steepest = std::max(kSteepest, std::abs(before)); // who stands steeper need not come down
    const double after = std::clamp(before + radians.y, -steepest, steepest);
    const Vec3d along = turned(normalize(level), upright, radians.x);
    return (along * std::cos(after) + upright * std::sin(after)) * distance;
}

// With `digits` behind the point at most, and no zeros at the end.
std::string decimals(double value, int digits) {
    std::string text = fmt::format("{:.{}f}", value, digits);
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') text.pop_back();
    }
    return text == "-0" ? "0" : text;
}

std::string triple(Vec3d v, int digits) {
    return fmt::format("{} {} {}", decimals(v.x, digits), decimals(v.y, digits), decimals(v.z, digits));
}

} // namespace

CameraPose orbited(const CameraPose& pose, Vec2d radians) {
    CameraPose moved = pose;
    moved.from = pose.lookAt + turnedUpright(pose.from - pose.lookAt, pose.up, radians);
    return moved;
}

CameraPose lookedAround(const CameraPose& pose, Vec2d radians) {
    CameraPose moved = pose;
    moved.lookAt = pose.from + turnedUpright(pose.lookAt - pose.from, pose.up, {-radians.x, radians.y});
    return moved;
}

CameraPose panned(const CameraPose& pose, Vec2d heights, double height) {
    const PoseAxes axes = axesOf(pose);
    const Vec3d way = (axes.right * heights.x + axes.up * heights.y) * height;
    CameraPose moved = pose;
    moved.from += way;
    moved.lookAt += way;
    return moved;
}

CameraPose dollied(const CameraPose& pose, double factor) {
    CameraPose moved = pose;
    const Vec3d away = pose.from - pose.lookAt;
    const double distance = std::clamp(length(away) * factor, kNearest, kFarthest);
    moved.from = pose.lookAt + normalize(away) * distance;
    moved.size = std::clamp(pose.size * factor, 1e-9, 1e9);
    return moved;
}

CameraPose flown(const CameraPose& pose, Vec3d shares) {
    const PoseAxes axes = axesOf(pose);
    const double distance = length(pose.lookAt - pose.from);
    const Vec3d way = (axes.right * shares.x + normalize(pose.up) * shares.y + axes.ahead * shares.z) * distance;
    CameraPose moved = pose;
    moved.from += way;
    moved.lookAt += way;
    return moved;
}

std::string poseLines(const CameraPose& pose, double unit, Vec3d upright) {
    const double distance = length(pose.lookAt - pose.from) / unit;
    const int digits = std::clamp(static_cast<int>(std::ceil(6 - std::log10(distance))), 0, 12);
    std::string lines =
        fmt::format("from {}\nlook-at {}", triple(pose.from / unit, digits), triple(pose.lookAt / unit, digits));
    const Vec3d up = normalize(pose.up);
    if (length(up - upright) > 1e-9) lines += "\nup " + triple(up, 7);
    return lines;
}

} // namespace abbe

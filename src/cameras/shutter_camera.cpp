#include "cameras/shutter_camera.h"

#include "base/check.h"

namespace abbe {

ShutterCamera::ShutterCamera(std::unique_ptr<const Camera> inner, const Motion& toRender, const Shutter& shutter)
    : inner_(std::move(inner)), toRender_(toRender), shutter_(shutter) {
    const auto inverse = toRender.at(shutter.open).inverse();
    ABBE_CHECK(inverse);
    fromOpening_ = *inverse;
}

std::optional<Vec2d> ShutterCamera::project(Vec3d p, double time, Vec2d near) const noexcept {
    if (!toRender_.moves()) return inner_->project(p, time, near);
    const auto back = fromOpening_.then(toRender_.at(shutter_.timeAt(time))).inverse();
    return back ? inner_->project(back->point(p), time, near) : std::nullopt;
}

CameraRay ShutterCamera::ray(const CameraSample& sample) const noexcept {
    CameraRay result = inner_->ray(sample);
    const double position = shutter_.position(static_cast<double>(sample.time));
    result.ray.time = static_cast<float>(position);
    if (!toRender_.moves()) return result;
    const Transform moved = fromOpening_.then(toRender_.at(shutter_.timeAt(position)));
    result.ray.origin = Vec3(moved.point(Vec3d(result.ray.origin)));
    result.ray.direction = Vec3(normalize(moved.vector(Vec3d(result.ray.direction))));
    return result;
}

} // namespace abbe

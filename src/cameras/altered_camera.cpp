#include "cameras/altered_camera.h"

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
    const auto back = moved(time).inverse();
    return back ? inner_->project(back->point(p), time, near) : std::nullopt;
}

CameraRay ShutterCamera::ray(const CameraSample& sample) const noexcept {
    CameraRay result = inner_->ray(sample);
    const double position = shutter_.position(static_cast<double>(sample.time));
    result.ray.time = static_cast<float>(position);
    if (!toRender_.moves()) return result;
    const Transform there = moved(position);
    result.ray.origin = Vec3(there.point(Vec3d(result.ray.origin)));
    result.ray.direction = Vec3(normalize(there.vector(Vec3d(result.ray.direction))));
    return result;
}

// Times of the density that ray() gives them need no weight.
float ShutterCamera::rayTime(float u) const noexcept {
    return static_cast<float>(shutter_.position(static_cast<double>(u)));
}

// A rigid motion changes no length, area or solid angle.
std::optional<LensConnection> ShutterCamera::connect(const LensQuery& query) const noexcept {
    if (!toRender_.moves()) return inner_->connect(query);
    const Transform there = moved(static_cast<double>(query.time));
    const auto back = there.inverse();
    if (!back) return std::nullopt;
    LensQuery still = query;
    still.p = Vec3(back->point(Vec3d(query.p)));
    auto result = inner_->connect(still);
    if (!result) return std::nullopt;
    result->lens = Vec3(there.point(Vec3d(result->lens)));
    result->wi = Vec3(normalize(there.vector(Vec3d(result->wi))));
    return result;
}

float ShutterCamera::pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept {
    if (!toRender_.moves()) return inner_->pdfFacingArea(query, ray);
    const auto back = moved(static_cast<double>(ray.ray.time)).inverse();
    if (!back) return 0;
    LensQuery still = query;
    still.p = Vec3(back->point(Vec3d(query.p)));
    CameraRay before = ray;
    before.ray.origin = Vec3(back->point(Vec3d(ray.ray.origin)));
    before.ray.direction = Vec3(normalize(back->vector(Vec3d(ray.ray.direction))));
    return inner_->pdfFacingArea(still, before);
}

} // namespace abbe

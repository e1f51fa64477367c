// Where camera paths start, beside the ray itself.
#pragma once

#include "transport/surroundings.h"
#include "transport/walk.h"

#include <algorithm>

namespace abbe {

// Half of what lies between the rays of two neighbouring pixels, and half of that again: textures are averaged over
// less than the filter covers, which averages the rest. `ray`: the camera's of `at`. Where no ray is next to it,
// nothing.
inline RayCone coneOf(const Camera& camera, const CameraSample& at, const Ray& ray) {
    for (const float step : {1.f, -1.f}) {
        CameraSample next = at;
        next.film.x += step;
        const CameraRay other = camera.ray(next);
        if (other.weight > 0)
            return {0.25f * length(other.ray.origin - ray.origin), 0.25f * length(other.ray.direction - ray.direction)};
    }
    return {};
}

// What is around the origins of camera rays. Those of a pinhole share their origin, and what is around it.
class CameraSurroundings {
  public:
    // Until the next question.
    const Surroundings& at(const Scene& scene, const Ray& ray) {
        const auto contains = [&](const Bounds3& filled) { return filled.contains(ray.origin); };
        if (ray.origin == origin_) return surroundings_;
        surroundings_ = {};
        origin_ = ray.origin;
        if (std::ranges::any_of(scene.filled, contains)) surroundings_ = surroundingsAt(scene, ray.origin, ray.time);
        return surroundings_;
    }

  private:
    Vec3 origin_{kInfinity, kInfinity, kInfinity};
    Surroundings surroundings_;
};

// What a path that starts with the camera's ray of `at` runs in, and how wide it is. `around`: a CameraSurroundings,
// where dielectrics may be nested.
template <EffectBits E, typename Around>
void startFromCamera(PathWalk<E>& walk, const CameraSample& at, const CameraRay& camera,
                     [[maybe_unused]] Around& around) {
    const Scene& scene = walk.context.scene;
    if constexpr (PathWalk<E>::kInterfaces) walk.startIn(around.at(scene, camera.ray));
    if constexpr (PathWalk<E>::kTextures) walk.startWith(coneOf(*scene.camera, at, camera.ray));
}

} // namespace abbe

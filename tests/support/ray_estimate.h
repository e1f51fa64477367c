// The radiance along one ray, over many paths of the kernel with all effects.
#pragma once

#include "support/scene_test_paths.h"
#include "transport/surroundings.h"

namespace abbe::test {

struct RayEstimate {
    double mean = 0, error = 0; // over all wavelengths; of the mean
    std::uint64_t capped = 0;
};

// The ray starts in world space; what it starts in surrounds it.
inline RayEstimate seenAlong(const TestScene& scene, Vec3 origin, Vec3 direction, std::uint32_t paths = 40000) {
    constexpr EffectBits all = kLoopEffects.bits();
    const LightSampler lights(scene.scene().lights);
    const PathContext context{scene.scene(), lights, {}, true};
    auto media = PathWalk<all>::makeMedia(scene.scene());
    Sampler sampler;
    sampler.startPixel(7, Technique::Numbers::random, true);
    Arena arena;
    PathCounters counters;
    const Vec3 eye = Vec3(Vec3d(origin) - scene.scene().origin);
    const Surroundings around = surroundingsAt(scene.scene(), eye, 0);
    double sum = 0, squares = 0;
    for (std::uint32_t i = 0; i < paths; ++i) {
        sampler.start(i);
        CameraPath<all> path(context, sampler, arena, counters, media);
        path.walk().startIn(around);
        const double x = mean(path.radiance({eye, normalize(direction)}, Wavelengths::sample(0.3f), 1));
        sum += x;
        squares += x * x;
    }
    const double n = paths, m = sum / n;
    return {m, std::sqrt(std::max(0.0, squares / n - m * m) / n), counters.capped};
}

} // namespace abbe::test

// Camera paths without the renderer around it: no passes, no tiles, and wavelengths and roulette as the test wants.
#pragma once

#include "base/parallel.h"
#include "path_tracing/camera_path.h"
#include "spectrum/sensor.h"
#include "support/scene_test.h"

#include <functional>

namespace abbe::test {

struct PathTestSettings {
    std::uint32_t samples = 64; // of each replicate
    std::uint64_t seed = 1;
    std::uint32_t maxDepth = 0;
    int replicates = 8;
    float rouletteScale = 1; // see RouletteReference
    std::function<Wavelengths(double u)> wavelengths = [](double u) { return WavelengthDensity().sample(u); };
};

// One wavelength in all lanes, uniform over the film's range: no hero, no rotations.
inline Wavelengths oneWavelength(double u) {
    const float range = kMaxWavelength - kMinWavelength;
    return Wavelengths::at(Spectrum(kMinWavelength + range * static_cast<float>(u)), Spectrum(1 / range));
}

template <EffectBits E> RecordingFilm renderPaths(const TestScene& test, const PathTestSettings& s) {
    RecordingFilm film(test.built().film, s.replicates);
    const Scene& scene = test.scene();
    const LightSampler lights(scene.lights);
    RenderSettings settings;
    settings.maxDepth = s.maxDepth;
    const PathContext context{scene, lights, settings, true};
    const PixelBounds b = film.bounds();
    parallelFor(static_cast<std::size_t>(b.area()), [&](std::size_t pixel) {
        const int x = b.x0 + static_cast<int>(pixel) % b.width(), y = b.y0 + static_cast<int>(pixel) / b.width();
        Sampler sampler;
        Arena arena;
        PathCounters counters;
        auto media = PathWalk<E>::makeMedia(scene);
        for (int r = 0; r < s.replicates; ++r) {
            const std::uint64_t seed = combine64(combine64(s.seed, pixel), static_cast<std::uint64_t>(r) + 1000);
            Xyz sum;
            sampler.startPixel(seed, Technique::Numbers::sobol, true);
            for (std::uint32_t i = 0; i < s.samples; ++i) {
                sampler.startPixel(seed, Technique::Numbers::sobol, true);
                sampler.start(i);
                const FilterSample filter = film.filter(sampler.film());
                const CameraRay eye = scene.camera->ray(
                    {{static_cast<float>(x) + 0.5f + filter.offset.x, static_cast<float>(y) + 0.5f + filter.offset.y},
                     sampler.lens(),
                     sampler.time()});
                const Wavelengths lambda = s.wavelengths(sampler.wavelength());
                CameraPath<E> path(context, sampler, arena, counters, media);
                sum += toXyz(path.radiance(eye.ray, lambda, s.rouletteScale), lambda) *
                       static_cast<double>(eye.weight * filter.weight);
            }
            film.add(x, y, r, sum, s.samples);
        }
    });
    return film;
}

} // namespace abbe::test

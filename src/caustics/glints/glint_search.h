// Camera paths over delta interfaces, for who looks for glints before a render.
#pragma once

#include "integrators/camera_start.h"
#include "integrators/glint_loop.h"
#include "math/hash.h"

#include <functional>
#include <optional>
#include <span>

namespace abbe {

struct GlintQuery {
    Vec2 film;                       // as CameraSample::film
    float wavelength = 0.5f;         // of the hero, as WavelengthDensity::sample() takes it
    std::optional<GlintChain> chain; // which events to take; without them they are drawn, either alike
    std::uint64_t seed = 0;          // for that, and for the place on the lens and the time
};

// Of the query with this number: what is seen behind each event, at these wavelengths.
using GlintHearer = std::function<void(std::size_t, const GlintView&, const Wavelengths&)>;

template <EffectBits E>
void searchGlints(const PathContext& context, std::span<const GlintQuery> queries, PathCounters& counters,
                  const GlintHearer& hear) {
    Sampler sampler;
    Arena arena;
    auto media = GlintLoop<E>::makeMedia(context.scene, *context.stop);
    CameraSurroundings around;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const GlintQuery& query = queries[i];
        sampler.startPixel(query.seed, Technique::Numbers::sobol, true);
        sampler.start(0);
        const Wavelengths lambda = context.scene.wavelengths.sample(query.wavelength);
        const CameraSample at{query.film, sampler.lens(), sampler.time(), lambda.nm[0]};
        const CameraRay camera = context.scene.camera->ray(at);
        if (!(camera.weight > 0)) continue;
        GlintLoop<E> loop(context, sampler, arena, counters, media);
        loop.startIn(around.at(context.scene, camera.ray));
        loop.startWith(coneOf(*context.scene.camera, at, camera.ray));
        if (camera.heroOnly) loop.startWithHero();
        const auto tell = [&](const GlintView& view) { hear(i, view, loop.wavelengths()); };
        RandomStream random(query.seed);
        if (query.chain)
            loop.follow(camera.ray, lambda, *query.chain, tell);
        else
            loop.walk(
                camera.ray, lambda,
                [&](const GlintChain&, bool reflects, bool transmits) -> std::optional<bool> {
                    if (!reflects && !transmits) return std::nullopt;
                    return reflects && transmits ? random.uniform() < 0.5f : transmits;
                },
                tell);
        if constexpr (hasEffect(E, Effect::dispersion)) removeWorkFlag(WorkFlag::heroOnly);
    }
}

} // namespace abbe

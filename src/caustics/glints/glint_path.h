// Camera paths over delta interfaces alone, whose events are chosen and not drawn.
#pragma once

#include "caustics/glints/glint_search.h"
#include "caustics/shared/kernel_jobs.h"
#include "math/hash.h"
#include "transport/camera_start.h"
#include "transport/walk.h"

#include <optional>
#include <span>

namespace abbe {

// Through the same media and boundaries as other camera paths.
template <EffectBits E> class GlintPath {
    using Walk = PathWalk<E>;
    static_assert(Walk::kLightPaths);

  public:
    using Media = typename Walk::Media;

    // What it is given outlives it.
    GlintPath(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters, Media& media)
        : walk_(context, sampler, arena, counters, media) {}

    // Whose start is set from outside.
    Walk& walk() { return walk_; }

    // `heroOnly`: the ray is that of the hero alone. choose(chain, reflects, transmits): whether light is let through
    // at the next vertex, which can do the one or the other, given the events so far; nothing to end. tell(const
    // GlintView&): what is seen after each event.
    template <typename Choose, typename Tell>
    void trace(Ray ray, const Wavelengths& lambda, bool heroOnly, Choose choose, Tell tell);
    // The events of `chain`; tells of what is seen behind the last.
    template <typename Tell>
    void follow(const Ray& ray, const Wavelengths& lambda, bool heroOnly, ChainSignature chain, Tell tell) {
        trace(
            ray, lambda, heroOnly,
            [&](const ChainSignature& so, bool, bool) {
                return so.length() < chain.length() ? std::optional(chain[so.length()] == ChainEvent::transmission)
                                                    : std::nullopt;
            },
            [&](const GlintView& view) {
                if (view.chain.length() == chain.length()) tell(view);
            });
    }

    // Of the path, as it is now.
    const Wavelengths& wavelengths() const { return walk_.path.lambda; }

  private:
    static constexpr std::uint32_t kLongest = ChainSignature::kMaxLength;

    Walk walk_;
};

template <EffectBits E>
template <typename Choose, typename Tell>
void GlintPath<E>::trace(Ray ray, const Wavelengths& lambda, bool heroOnly, Choose choose, Tell tell) {
    auto& path = walk_.path;
    walk_.start(lambda, ray.time, heroOnly);
    ChainSignature chain;
    double probability = 1;
    SurfaceHit hit;
    for (std::uint32_t depth = 0; depth <= kLongest; ++depth) {
        const Vec3 from = ray.origin, direction = ray.direction;
        const auto arrival = walk_.arrive(ray, hit, depth);
        if (arrival == Arrival::collision || !anyNonZero(path.beta)) return;
        const bool found = arrival == Arrival::surface;
        if (found) {
            hit.arrival = direction;
            hit.footprint = path.cone.radius;
        }
        if (depth > 0)
            tell(GlintView{chain, from, direction, path.beta * (1 / mean(path.densities.unidirectional)), probability,
                           found ? &hit : nullptr, path.time});
        if (!found || depth == kLongest) return;
        if (hit.material->bends()) hit.material->bend(hit);
        walk_.arena.reset();
        const Bsdf& bsdf = *hit.material->bsdf(hit, path.lambda, walk_.arena);
        const EyeDirection eye{hit.shading.toLocal(-direction), -direction};
        if (!bsdf.lobes().has(Lobe::delta)) return;
        const auto reflects = forcedLobe(bsdf, eye.wo, false), transmits = forcedLobe(bsdf, eye.wo, true);
        const std::optional<bool> event = choose(chain, reflects.has_value(), transmits.has_value());
        if (!event) return;
        const auto& next = *event ? transmits : reflects;
        if (!next || !walk_.scatter(hit, next->sample, eye, ray)) return;
        probability *= static_cast<double>(next->probability);
        chain.add(chainEvent(*event));
    }
}

// What the queries find, in their order.
template <EffectBits E>
void searchGlints(const PathContext& context, std::span<const GlintQuery> queries, PathCounters& counters,
                  const GlintCallback& report) {
    Sampler sampler;
    Arena arena;
    auto media = PathWalk<E>::makeMedia(context.scene, *context.stop);
    CameraSurroundings around;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const GlintQuery& query = queries[i];
        sampler.startPixel(query.seed, Technique::Numbers::sobol, true);
        sampler.start(0);
        const Wavelengths lambda = context.scene.wavelengths.sample(query.wavelength);
        const CameraSample at{query.film, sampler.lens(), sampler.time(), lambda.nm[0]};
        const CameraRay camera = context.scene.camera->ray(at);
        if (!(camera.weight > 0)) continue;
        GlintPath<E> path(context, sampler, arena, counters, media);
        startFromCamera(path.walk(), at, camera, around);
        const auto tell = [&](const GlintView& view) { report(i, view, path.wavelengths()); };
        RandomStream random(query.seed);
        if (query.chain)
            path.follow(camera.ray, lambda, camera.heroOnly, *query.chain, tell);
        else
            path.trace(
                camera.ray, lambda, camera.heroOnly,
                [&](const ChainSignature&, bool reflects, bool transmits) -> std::optional<bool> {
                    if (!reflects && !transmits) return std::nullopt;
                    return reflects && transmits ? random.uniform() < 0.5f : transmits;
                },
                tell);
        if constexpr (hasEffect(E, Effect::dispersion)) removeWorkFlag(WorkFlag::heroOnly);
    }
}

} // namespace abbe

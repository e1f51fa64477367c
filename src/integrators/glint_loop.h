// Camera paths over delta interfaces alone, whose events are chosen and not drawn.
#pragma once

#include "integrators/forced_lobe.h"
#include "integrators/path_loop.h"

#include <optional>

namespace abbe {

// A segment behind the first event.
struct GlintView {
    const GlintChain& chain; // so far
    Vec3 p, direction;       // where it starts, and where to, unit
    Spectrum throughput;     // radiance at the eye over that of what is seen here, per lane
    double probability;      // with which a camera path would have taken these events
    const SurfaceHit* hit;   // where it ends; null: nowhere
    float time = 0;          // as Ray::time

    // What a lamp gives in this direction, if it is what is seen.
    Spectrum emitted(const Light& light, const Wavelengths& lambda) const {
        if (hit) return hit->light == &light ? hit->light->emitted(*hit, -direction, lambda) : Spectrum(0.f);
        const DistantLight* const distant = light.asDistant();
        return distant && distant->hasExtent() ? distant->escaped(direction, lambda, time) : Spectrum(0.f);
    }
};

// Walked as those of PathLoop are, through the same media and boundaries.
template <EffectBits E> class GlintLoop : private PathLoop<E> {
    using Base = PathLoop<E>;
    static_assert(Base::kTraced);

  public:
    using Media = typename Base::Media;
    using Base::makeMedia;
    using Base::startIn;
    using Base::startWith;
    using Base::startWithHero;

    GlintLoop(const PathContext& context, Sampler& sampler, Arena& arena, PathCounters& counters, Media& media)
        : Base(context, sampler, arena, counters, media) {}

    // choose(chain, reflects, transmits): whether light is let through at the next vertex, which can do the one or the
    // other, given the events so far; nothing to end. tell(const GlintView&): what is seen after each event.
    template <typename Choose, typename Tell> void walk(Ray ray, const Wavelengths& lambda, Choose choose, Tell tell);
    // The events of `chain`; tells of what is seen behind the last.
    template <typename Tell> void follow(const Ray& ray, const Wavelengths& lambda, GlintChain chain, Tell tell) {
        walk(
            ray, lambda,
            [&](const GlintChain& so, bool, bool) {
                return so.length() < chain.length() ? std::optional(chain.transmits(so.length())) : std::nullopt;
            },
            [&](const GlintView& view) {
                if (view.chain.length() == chain.length()) tell(view);
            });
    }

    // Of the path, as it is now.
    const Wavelengths& wavelengths() const { return this->path_.lambda; }

  private:
    static constexpr std::uint32_t kLongest = GlintChain::kMaxLength;
};

template <EffectBits E>
template <typename Choose, typename Tell>
void GlintLoop<E>::walk(Ray ray, const Wavelengths& lambda, Choose choose, Tell tell) {
    auto& path = this->path_;
    path.lambda = lambda;
    path.time = ray.time;
    path.densities.film = lambda;
    if (this->startWithHero_) this->endSecondaryWavelengths();
    GlintChain chain;
    double probability = 1;
    SurfaceHit hit;
    for (std::uint32_t depth = 0; depth <= kLongest; ++depth) {
        this->countRay();
        const Vec3 from = ray.origin, direction = ray.direction;
        const auto arrival = this->arrive(ray, hit, depth);
        if (arrival == Base::Arrival::collision || !anyNonZero(path.beta)) return;
        const bool met = arrival == Base::Arrival::surface;
        if (met) {
            hit.arrival = direction;
            hit.footprint = path.cone.radius;
        }
        if (depth > 0)
            tell(GlintView{chain, from, direction, path.beta * this->scatteringWeight(0), probability,
                           met ? &hit : nullptr, path.time});
        if (!met || depth == kLongest) return;
        if (hit.material->bends()) hit.material->bend(hit);
        this->arena_.reset();
        const Bsdf& bsdf = *hit.material->bsdf(hit, path.lambda, this->arena_);
        const typename Base::Directions eye{hit.shading.toLocal(-direction), -direction};
        if (!bsdf.lobes().has(Lobe::delta)) return;
        const auto reflects = forcedLobe(bsdf, eye.wo, false), transmits = forcedLobe(bsdf, eye.wo, true);
        const std::optional<bool> event = choose(chain, reflects.has_value(), transmits.has_value());
        if (!event) return;
        const auto& next = *event ? transmits : reflects;
        if (!next || !this->scatter(hit, next->sample, eye, ray)) return;
        probability *= static_cast<double>(next->probability);
        chain.add(*event);
    }
}

} // namespace abbe

// How far camera paths go in media, drawn by what is known of the light there.
#pragma once

#include "guiding/radiance_cache.h"
#include "render/light.h"
#include "transport/walk.h"

#include <algorithm>
#include <array>

namespace abbe {

// Along one ray tracking finds several ways to go on, and one of them is taken, mostly in proportion to the light that
// is expected of each: what the place gives off where it is scattered, or what is behind all media. With the weight
// 1 / (ways × probability) that is the mean over all of them [Talbot2005], whatever was expected. So nothing has to be
// known of the density with which media stop rays, and weights are bounded. The places are those where a path without
// a guide might have come to, and a beam of light is met up to as many times more often as there are ways.
template <EffectBits E> class GuidedDistance {
    static constexpr bool kDispersion = PathWalk<E>::kDispersion;

  public:
    // All outlive it.
    GuidedDistance(PathWalk<E>& walk, const RadianceCache& cache, const MediaLeg& leg)
        : walk_(walk), cache_(cache), leg_(leg) {}

    // Weighs the path, as following the ray would. Emission is that on the first way, which is as good as any.
    MediumCollision choose(EmissionListener& emission) {
        const RandomStream random(leg_.random.bits()); // of all ways, which start with steps of different strata
        for (std::size_t i = 0; i < kWays; ++i) follow(i, random, i == 0 ? &emission : nullptr);
        const float u = leg_.random.uniform();
        // All come out behind the media alike: each is as likely as the others to be the first.
        if (std::ranges::none_of(ways_, [](const Way& way) { return way.collision.medium; })) return take(0, 1);
        expect();
        const auto [chosen, probability] = draw(u);
        const float weight = 1 / (kWays * probability);
        if (walk_.estimate.observer) [[unlikely]]
            walk_.estimate.observer->drawsDistance(weight);
        return take(chosen, weight);
    }

  private:
    // More of them find little more, and each takes as long as the first (docs/performance.md).
    static constexpr std::size_t kWays = 4;
    static constexpr std::uint64_t kTurn = ~std::uint64_t{0} / kWays + 1;
    // Of the choice, by the same chance for all: the cache knows no directions, and weights of many legs multiply.
    static constexpr float kEvenShare = 0.5f;

    struct Way {
        MediumCollision collision;
        Spectrum beta, density; // of the path, at the end
        float expected = 0;
    };
    struct Drawn {
        std::size_t way;
        float probability;
    };

    void follow(std::size_t i, RandomStream random, EmissionListener* emission) {
        auto& path = walk_.path;
        Way& way = ways_[i];
        way.beta = path.beta;
        TrackedWeights weights{&way.beta, nullptr};
        if constexpr (kDispersion) {
            way.density = path.densities.unidirectional;
            weights.density = &way.density;
        }
        const FirstStep first{1, i * kTurn};
        way.collision = walk_.media.tracker.follow(leg_.ray, leg_.tMax(), path.nested.here.media(), path.lambda, random,
                                                   weights, emission, first);
    }
    // Sets what is expected of each way.
    void expect() {
        float behind = -1; // not asked for yet
        for (Way& way : ways_) {
            float throughput = mean(abs(way.beta));
            if constexpr (kDispersion) throughput /= mean(way.density);
            const float t = way.collision.t;
            if (!way.collision.medium && behind < 0) behind = lightBehind();
            way.expected =
                throughput *
                (way.collision.medium ? cache_.at(leg_.ray.origin + leg_.ray.direction * t, kInMedium) : behind);
            if (!(way.expected >= 0 && way.expected < kInfinity)) way.expected = 0; // it is a guess, whatever it is
        }
    }
    // Lights as if nothing else found them: next-event estimation often leaves them to such rays.
    float lightBehind() const {
        const auto& path = walk_.path;
        const Vec3 direction = leg_.ray.direction;
        if (const SurfaceHit* hit = leg_.ahead) {
            if (hit->light) return mean(hit->light->emitted(*hit, -direction, path.lambda));
            return cache_.at(hit->p, faceAgainst(direction, hit->ng));
        }
        float sum = 0;
        for (const DistantLight* light : walk_.context.lights.infinite())
            if (light->visible().has(leg_.ray.kind)) sum += mean(light->escaped(direction, path.lambda, path.time));
        return sum;
    }
    Drawn draw(float u) const {
        constexpr float kEach = 1.f / kWays;
        float sum = 0;
        for (const Way& way : ways_) sum += way.expected;
        for (std::size_t i = 0;; ++i) {
            const float p = sum > 0 ? (1 - kEvenShare) * ways_[i].expected / sum + kEvenShare * kEach : kEach;
            if (u < p || i + 1 == kWays) return {i, p};
            u -= p;
        }
    }
    MediumCollision take(std::size_t i, float weight) {
        walk_.path.beta = ways_[i].beta * weight;
        if constexpr (kDispersion) walk_.path.densities.unidirectional = ways_[i].density;
        return ways_[i].collision;
    }

    PathWalk<E>& walk_;
    const RadianceCache& cache_;
    const MediaLeg& leg_;
    std::array<Way, kWays> ways_;
};

} // namespace abbe

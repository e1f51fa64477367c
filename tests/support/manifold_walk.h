// Paths that find lights by chance, as the path tracer does, as far as manifold sampling says that it has them already.
#pragma once

#include "caustics/shared/aim_cone.h"
#include "math/warp.h"
#include "support/manifold_cases.h"

namespace abbe::test {

// Which of the light that paths find is meant.
enum class Found { covered, others };

inline AimTarget ballOfCasters(const ManifoldSampler& sampler) {
    Bounds3 box;
    for (const SpecularCaster& c : sampler.plan().casters) box.add(c.shape->bounds());
    return {box.centre(), box.radius()};
}

// Mean of the light that arrives at a point in the world by chains, per unit of cosine: rays towards all casters
// are followed by the materials' own sampling. `spectral`: integrated over wavelengths, each path at one of them.
inline Moments walkTo(const ManifoldCase& test, Vec3 world, int paths, bool spectral = false,
                      Found wanted = Found::covered) {
    const Scene& scene = test.scene.scene();
    const ChainStart start = test.start(world);
    Moments result;
    Random random(91);
    Arena arena;
    const auto cone = AimCone::seen(ballOfCasters(*test.sampler), start.receiver.p);
    for (int i = 0; i < paths; ++i) {
        Wavelengths lambda = Wavelengths::sample(spectral ? random.uniform() : 0.3f);
        if (spectral) lambda.keepHero();
        CoveredChain chain;
        chain.start();
        const Vec2 u{random.uniform(), random.uniform()};
        Ray ray{start.receiver.p, cone ? cone->sample(u) : squareToSphere(u)};
        const Vec3 direction = ray.direction;
        Spectrum beta(cone ? static_cast<float>(1 / cone->pdf()) : 4 * kPi);
        double sum = 0;
        for (int length = 0; length <= kLongestManifoldChain; ++length) {
            SurfaceHit hit;
            if (!scene.intersector->intersect(ray, hit)) {
                for (const auto& light : scene.lights) {
                    const DistantLight* const distant = light->asDistant();
                    if (!distant || !distant->hasExtent()) continue;
                    const LightTarget met = LightTarget::ofHit(*distant, ray.direction, 0);
                    const bool covered = test.sampler->covers(chain, start, direction, met, lambda);
                    const Spectrum arriving = distant->escaped(ray.direction, lambda, 0) * beta;
                    if (length > 0 && covered == (wanted == Found::covered))
                        sum += static_cast<double>(mean(spectral ? arriving / lambda.pdf : arriving));
                }
                break;
            }
            const Curve* inside = dot(ray.direction, hit.ng) > 0 ? hit.material->absorption() : nullptr;
            if (inside) beta *= exp(inside->at(lambda) * -hit.distance);
            if (hit.light) {
                const Spectrum arriving = hit.light->emitted(hit, -ray.direction, lambda) * beta;
                const bool covered = test.sampler->covers(chain, start, direction, LightTarget::ofHit(hit, 0), lambda);
                if (length > 0 && covered == (wanted == Found::covered))
                    sum = static_cast<double>(mean(spectral ? arriving / lambda.pdf : arriving));
                break;
            }
            arena.reset();
            hit.arrival = ray.direction;
            const auto s = hit.material->bsdf(hit, lambda, arena)
                               ->sample(hit.shading.toLocal(-ray.direction), random.uniform(),
                                        {random.uniform(), random.uniform()}, Transport::radiance);
            if (!s) break;
            test.sampler->follow(chain, hit.shape, s->lobe);
            beta *= s->weight;
            const Vec3 w = normalize(hit.shading.toWorld(s->wi));
            ray = {spawnOrigin(hit, w), w};
        }
        result.add(sum);
    }
    return result;
}

} // namespace abbe::test

// Paths that find lamps by chance, as the path tracer does, as far as manifold sampling says that it has them already.
#pragma once

#include "math/warp.h"
#include "support/manifold_cases.h"

namespace abbe::test {

// Mean of the light that arrives at a point in the world by covered chains, per unit of cosine: rays in all directions
// are followed by the materials' own sampling. `spectral`: integrated over wavelengths, each path at one of them.
inline Moments walkTo(const ManifoldCase& test, Vec3 world, int paths, bool spectral = false) {
    const Scene& scene = test.scene.scene();
    const ChainStart start = test.start(world);
    Moments result;
    Random random(91);
    Arena arena;
    for (int i = 0; i < paths; ++i) {
        Wavelengths lambda = Wavelengths::sample(spectral ? random.uniform() : 0.3f);
        if (spectral) lambda.keepHero();
        CoveredChain chain;
        chain.start();
        Ray ray{start.receiver.p, squareToSphere({random.uniform(), random.uniform()})};
        Spectrum beta(4 * kPi);
        double light = 0;
        for (int length = 0; length <= ChainSignature::kMaxLength; ++length) {
            SurfaceHit hit;
            if (!scene.intersector->intersect(ray, hit)) break;
            const Curve* inside = dot(ray.direction, hit.ng) > 0 ? hit.material->absorption() : nullptr;
            if (inside) beta *= exp(inside->at(lambda) * -hit.distance);
            if (hit.light) {
                const Spectrum arriving = hit.light->emitted(hit, -ray.direction, lambda) * beta;
                if (test.sampler->covers(chain, hit.light))
                    light = static_cast<double>(mean(spectral ? arriving / lambda.pdf : arriving));
                break;
            }
            arena.reset();
            hit.arrival = ray.direction;
            const auto s = hit.material->bsdf(hit, lambda, arena)
                               ->sample(hit.shading.toLocal(-ray.direction), random.uniform(),
                                        {random.uniform(), random.uniform()}, Transport::radiance);
            if (!s) break;
            test.sampler->follow(chain, hit, s->lobe);
            beta *= s->weight;
            const Vec3 w = normalize(hit.shading.toWorld(s->wi));
            ray = {spawnOrigin(hit, w), w};
        }
        result.add(light);
    }
    return result;
}

} // namespace abbe::test

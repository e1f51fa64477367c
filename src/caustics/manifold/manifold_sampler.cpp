#include "caustics/manifold/manifold_sampler.h"

#include "caustics/manifold/caster_candidates.h"
#include "caustics/manifold/chain_tracer.h"
#include "caustics/shared/aim_cone.h"
#include "math/warp.h"

namespace abbe {

namespace {

constexpr double kLongestNewtonStep = 1; // of Newton's method, over the sine of half the cone of first directions

// First directions of trials: even over the cone of the caster's ball. From within the ball one half is even over all
// that the receiver can see, the other leads to points of the shape.
class Seeds {
  public:
    Seeds(const ChainStart& start, const SpecularCaster& caster) : receiver_(start.receiver), points_(*caster.shape) {
        if (!(caster.radius < kInfinity)) return;
        cone_ = AimCone::seen({caster.centre, caster.radius}, receiver_.p);
        const double distance = length(Vec3d(caster.centre) - Vec3d(receiver_.p));
        if (cone_) size_ = std::min(1.0, static_cast<double>(caster.radius) / distance);
    }

    Vec3d draw(RandomStream& random) const {
        const Vec2 u{random.uniform(), random.uniform()};
        if (cone_) return normalize(Vec3d(cone_->sample(u)));
        const std::uint64_t choice = random.bits();
        if (choice & 1)
            if (const auto w = towardsShape(choice >> 32, u)) return *w;
        const Vec3d w = normalize(Vec3d(squareToSphere(u)));
        return receiver_.oneSided() && dot(w, Vec3d(receiver_.n)) < 0 ? -w : w;
    }
    double size() const { return size_; } // sine of half the cone; 1 from within the ball
    // Solutions nearer to each other count as one. Newton's method leaves errors of less, but next to caustics, where
    // two solutions meet: those that are told apart no more hold about as much of the light as this is of the cone.
    bool same(Vec3d a, Vec3d b) const { return lengthSquared(a - b) < square(1e-4 * size_); }

  private:
    std::optional<Vec3d> towardsShape(std::uint64_t choice, Vec2 u) const {
        const auto part = static_cast<std::uint32_t>(choice * points_->emitterParts() >> 32);
        const auto point = points_->samplePoint(part, u);
        if (!point) return std::nullopt;
        const Vec3d d = Vec3d(point->p) - Vec3d(receiver_.p);
        return lengthSquared(d) > 0 ? std::optional(normalize(d)) : std::nullopt;
    }

    const Receiver& receiver_;
    SamplingOf points_; // of the shape
    std::optional<AimCone> cone_;
    double size_ = 1;
};

float preference(const SpecularCaster& caster, Vec3 p) {
    constexpr float kLeastReach = 0.02f; // small ones are drawn, too
    return std::min(1.f, square(caster.radius) / lengthSquared(caster.centre - p)) + kLeastReach;
}

// dω at the receiver per area across the light's last ray, or per solid angle of a light far away.
double directionsPerTarget(const SpecularChain& chain) { return 1 / (std::abs(chain.determinant()) * chain.spread2); }

// sr that the light would fill if it were everywhere as here; 0 for a light that is a point.
double imageSize(const SpecularChain& chain, const LightTarget& target) {
    if (target.delta) return 0;
    const Vec3 w = -Vec3(chain.last().out);
    const float cosine = target.distant ? 1 : target.origin.cosine(w);
    return directionsPerTarget(chain) * static_cast<double>(cosine / target.pdf);
}

// A finished chain's light, of which the choice of light and chain was made with these densities.
std::optional<ManifoldSample> weigh(const SpecularChain& chain, const LightTarget& target, const ManifoldChoice& choice,
                                    Wavelengths lambda) {
    ManifoldSample sample;
    sample.wi = normalize(Vec3(chain.direction));
    Spectrum light = chain.clearness;
    for (int i = 0; i < chain.length; ++i) {
        const ChainVertex& v = chain.vertices[static_cast<std::size_t>(i)];
        Arena arena;
        const Bsdf& bsdf = *v.hit.material->bsdf(v.hit, lambda, arena);
        const Vec3 wo(v.hit.shading.toLocal(-v.in)), wi(v.hit.shading.toLocal(v.out));
        light *= v.clearness * bsdf.evalDelta(wo, wi).ratio;
        const bool refracts = choice.signature[i] == ChainEvent::transmission;
        if (refracts && !sample.heroOnly && bsdf.lobes().has(Lobe::dispersive)) {
            sample.heroOnly = true;
            lambda.keepHero();
        }
    }
    const Vec3 leaves = normalize(-Vec3(chain.last().out));
    light *= target.leaving(leaves, lambda);
    sample.light = target.light;
    sample.length = chain.length;
    if (!target.delta) sample.radiance = light * (1 / (target.distant ? 1 : target.origin.cosine(leaves)));
    const double densities = static_cast<double>(target.pdf) * target.pick * choice.probability;
    light *= static_cast<float>(directionsPerTarget(chain) / densities);
    if (sample.heroOnly) light = Spectrum(Float8{light[0] * static_cast<float>(kLanes), 0, 0, 0, 0, 0, 0, 0});
    if (!anyNonZero(light) || !allFinite(light)) return std::nullopt;
    sample.irradiance = light;
    return sample;
}

} // namespace

ManifoldSampler::ManifoldSampler(const Scene& scene, ManifoldPlan plan) : scene_(scene), plan_(std::move(plan)) {
    for (const CasterCandidate& candidate : casterCandidates(scene))
        if (candidate.obstacle.empty()) followed_.insert(candidate.shape);
    std::vector<double> weights;
    for (std::uint32_t i = 0; i < plan_.casters.size(); ++i) {
        const SpecularCaster& caster = plan_.casters[i];
        ABBE_CHECK(followed_.contains(caster.shape) && caster.radius > 0);
        casters_.emplace(caster.shape, i);
        weights.assign(caster.weights.begin(), caster.weights.end());
        signatureChoice_.emplace_back(weights);
        ABBE_CHECK(signatureChoice_.back().total() > 0);
    }
    weights.clear();
    for (std::uint32_t i = 0; i < plan_.lights.size(); ++i) {
        const ManifoldPlan::SampledLight& sampled = plan_.lights[i];
        ABBE_CHECK(sampled.light->paths() != LightPaths::none && sampled.weight > 0);
        lights_.emplace(sampled.light, i);
        weights.push_back(static_cast<double>(sampled.weight));
    }
    if (!weights.empty()) lightChoice_.emplace(weights);
}

std::optional<LightTarget> ManifoldSampler::drawTarget(const Wavelengths& lambda, float time,
                                                       RandomStream& random) const noexcept {
    const BinSample bin = lightChoice_->sample(random.uniform());
    const Light& light = *plan_.lights[bin.index].light;
    const std::uint32_t parts = light.parts();
    const auto part = static_cast<std::uint32_t>((random.bits() >> 32) * parts >> 32);
    const Vec2 u{random.uniform(), random.uniform()};
    return LightTarget::sample(light, part, static_cast<float>(bin.probability), u, lambda, time);
}

ManifoldChoice ManifoldSampler::choose(Vec3 p, RandomStream& random) const noexcept {
    float total = 0;
    for (const SpecularCaster& caster : plan_.casters) total += preference(caster, p);
    float u = random.uniform() * total;
    ManifoldChoice choice;
    for (; choice.caster + 1 < plan_.casters.size(); ++choice.caster) {
        const float own = preference(plan_.casters[choice.caster], p);
        if (u < own) break;
        u -= own;
    }
    const BinSample bin = signatureChoice_[choice.caster].sample(random.uniform());
    choice.signature = ManifoldKinds::ofIndex(bin.index);
    choice.probability = static_cast<float>(bin.probability) * preference(plan_.casters[choice.caster], p) / total;
    return choice;
}

bool ManifoldSampler::isSmall(const SpecularChain& chain, const LightTarget& target) const noexcept {
    const float largest = plan_.lights[lights_.at(target.light)].largestImage;
    return imageSize(chain, target) < static_cast<double>(largest);
}

std::optional<ManifoldSample> ManifoldSampler::estimate(const ChainStart& start, const LightTarget& target,
                                                        const ManifoldChoice& choice, const Wavelengths& lambda,
                                                        RandomStream& random, ManifoldCounts& counts,
                                                        MediumTracker* media) const noexcept {
    const SpecularCaster& caster = plan_.casters[choice.caster];
    ChainTracer tracer(scene_, followed_, start, target, lambda);
    const Seeds seeds(start, caster);
    ChainSolver solver(tracer, kLongestNewtonStep * seeds.size());
    const auto trial = [&] {
        ++counts.trials;
        return solver.solve(seeds.draw(random), choice.signature, caster.shape);
    };
    std::optional<ManifoldSample> sample;
    ++counts.estimates;
    const SpecularChain* const chain = trial();
    const bool small = chain && isSmall(*chain, target);
    const bool seen = small && !(start.receiver.oneSided() && dot(chain->direction, Vec3d(start.receiver.n)) < 0);
    if (seen && tracer.reachesLight(solver.solution())) {
        const Vec3d found = chain->direction;
        bool whole = true;
        if (media) {
            tracer.lookAtMedia(media, random);
            whole = tracer.trace(found, choice.signature, caster.shape, solver.solution()) &&
                    tracer.reachesLight(solver.solution());
            tracer.lookAtMedia(nullptr, random);
        }
        if (whole) sample = weigh(*chain, target, choice, lambda);
        if (sample) {
            const auto back = [&](const SpecularChain* again) { return again && seeds.same(again->direction, found); };
            std::uint32_t until = 1; // it comes back
            while (!back(trial()) && !sample->capped) sample->capped = ++until >= plan_.maxTrials;
            sample->irradiance *= static_cast<float>(until);
            ++counts.found;
            counts.capped += sample->capped;
        }
    }
    counts.rays += tracer.rays();
    counts.iterations += solver.iterations();
    return sample;
}

std::optional<ManifoldSample> ManifoldSampler::sample(const ChainStart& start, const Wavelengths& lambda,
                                                      RandomStream& random, ManifoldCounts& counts,
                                                      MediumTracker* media) const noexcept {
    const auto target = drawTarget(lambda, start.time, random);
    if (!target) return std::nullopt;
    const ManifoldChoice choice = choose(start.receiver.p, random);
    return estimate(start, *target, choice, lambda, random, counts, media);
}

void ManifoldSampler::follow(CoveredChain& chain, const Shape* shape, Lobes lobe) const noexcept {
    if (!chain.following) return;
    const bool first = chain.signature.length() == 0;
    const bool longer = chain.signature.length() == kLongestManifoldChain;
    chain.following = !longer && lobe.has(Lobe::delta) && followed_.contains(shape);
    if (!chain.following) return;
    if (first) {
        const auto found = casters_.find(shape);
        chain.following = found != casters_.end();
        if (!chain.following) return;
        chain.caster = found->second;
    }
    chain.signature.add(chainEvent(lobe.has(Lobe::transmission)));
}

bool ManifoldSampler::coversKind(const CoveredChain& chain, const Light* light) const noexcept {
    return chain.following && chain.signature.length() > 0 && lights_.contains(light) &&
           plan_.casters[chain.caster].weights[ManifoldKinds::indexOf(chain.signature)] > 0;
}

bool ManifoldSampler::covers(const CoveredChain& chain, const ChainStart& start, Vec3 direction, const LightTarget& hit,
                             const Wavelengths& lambda) const noexcept {
    if (!coversKind(chain, hit.light) || !(hit.pdf > 0)) return false;
    const SpecularCaster& caster = plan_.casters[chain.caster];
    ChainTracer tracer(scene_, followed_, start, hit, lambda);
    SpecularChain again;
    return tracer.trace(normalize(Vec3d(direction)), chain.signature, caster.shape, again) && isSmall(again, hit);
}

} // namespace abbe

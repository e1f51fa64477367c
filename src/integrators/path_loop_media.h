// The part of the path loop that exists only in scenes with media. Included by path_loop.h.
#pragma once

namespace abbe {

// Adds up what media give off along a ray, weighed against sampling them as lights.
template <EffectBits E> class PathLoop<E>::GlowCollector final : public EmissionListener {
  public:
    GlowCollector(PathLoop& loop, const Ray& ray) : loop_(loop), ray_(ray) { minds = loop.observer_ != nullptr; }

    void absorbs(float t, float share) override { loop_.observer_->absorbs(ray_.origin + ray_.direction * t, share); }

    void shines(const MediumEmission& emission, float t, const Spectrum& amount, const Spectrum& beta,
                const Spectrum& density) override {
        PathState<E>& path = loop_.path_;
        if (loop_.context_.scene.hidden.splits && !loop_.arrivesAlike(ray_, t)) [[unlikely]]
            return;
        float lightPdf = 0;
        if (!path.delta && loop_.context_.how.asksLights)
            lightPdf = loop_.context_.lights.probability(&emission, path.from, path.scatters) *
                       emission.pdfSolidAngle(path.from.p, ray_.origin + ray_.direction * t);
        loop_.checkDensity(lightPdf);
        Spectrum arriving = beta * amount * loop_.scatteringWeight(lightPdf, density);
        arriving *= loop_.clearness(path.nested.here, t);
        loop_.gather(arriving, &emission, false, [&] {
            loop_.observer_->lightsUp(ray_.origin + ray_.direction * t);
            loop_.observer_->meets(&emission, amount, lightPdf);
        });
    }

  private:
    PathLoop& loop_;
    const Ray& ray_;
};

// Where a ray collides. So near to the surface in front that rounding might put it beyond, it is where rays spawn
// before that surface: outside of the shape whose interior it is in, a path would not find back.
inline Vec3 placeOfCollision(const Ray& ray, float t, const SurfaceHit* ahead) {
    const Vec3 p = ray.origin + ray.direction * t;
    if (!ahead) return p;
    constexpr float kRounding = 0x1p-22f;
    const Vec3 far = max(abs(ray.origin), abs(p)), error = ahead->pError + far * kRounding;
    const float depth = (ahead->distance - t) * std::abs(dot(ray.direction, ahead->ng));
    if (depth > error.x + error.y + error.z) return p;
    return spawnOrigin(*ahead, -ray.direction);
}

// A unit direction at an angle to another one; u in [0, 1) turns it around.
inline Vec3 directionAbout(Vec3 axis, float cosine, float u) {
    const float sine = safeSqrt((1 - cosine) * (1 + cosine)), azimuth = 2 * kPi * u;
    const Frame frame = Frame::fromNormal(axis);
    return normalize(frame.toWorld({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine}));
}

// Follows the ray up to the surface ahead, if any; true if the path collided on the way, where the ray then starts.
template <EffectBits E>
bool PathLoop<E>::collides(Ray& ray, const SurfaceHit* ahead, RandomStream& random, std::uint32_t depth,
                           std::uint32_t crossings) {
    const float tMax = ahead ? ahead->distance : kInfinity;
    TrackedWeights weights{&path_.beta, nullptr};
    if constexpr (kDispersion) weights.density = &path_.densities.unidirectional;
    GlowCollector glow(*this, ray);
    setWork(Work::lights);
    if (kTraced && legs_)
        legs_->goes(ray, tMax);
    else
        sampleNearLight(ray, tMax, depth, crossings);
    setWork(Work::surface);
    const MediumCollision collision =
        media_.tracker.follow(ray, tMax, path_.nested.here.media(), path_.lambda, random, weights, &glow);
    if constexpr (kAbsorption)
        if (ahead) absorb(*ahead, ray.direction, collision.medium ? collision.t : tMax);
    if (!collision.medium) return false;
    media_.leg.collision = collision.t;
    if constexpr (kTextures) path_.cone.advance(collision.t);
    ray.origin = placeOfCollision(ray, collision.t, ahead);
    collided_ = collision.medium;
    return true;
}

// The vertex at the ray's origin. Phase functions are sampled exactly, so that their weight is 1 but for wavelengths.
template <EffectBits E> bool PathLoop<E>::scatterInMedium(Ray& ray, std::uint32_t depth) {
    touch(*collided_);
    if constexpr (kTraced)
        if (depth == 0) beginTraced(ray.origin);
    const WorkScope work(volumeWork(collided_->number));
    if (!anyNonZero(path_.beta)) return false;
    const PhaseFunction& phase = collided_->phase();
    const VertexSample sample = sampler_.vertex(depth);
    if (observer_) [[unlikely]]
        observer_->collides(ray.origin, path_.beta);
    setWork(Work::lights);
    sampleLightInMedium(ray.origin, ray.direction, sample, depth);
    setWork(volumeWork(collided_->number));
    const float even = context_.how.evenly ? context_.how.evenShare(depth) : 0;
    const float cosine = sample.lobe < even ? 1 - 2 * sample.bsdf.x : phase.sampleCosine(sample.bsdf.x);
    const Blame blame{collided_, "phase function"};
    if (!(std::abs(cosine) < 1.001f)) condemn(cosine, blame);
    path_.from = ray.origin;
    path_.scatters.outline.count = 0;
    path_.bsdfPdf = phase.value(cosine);
    checkDensity(path_.bsdfPdf, blame);
    if (even > 0) [[unlikely]] {
        ownPdf_ = path_.bsdfPdf;
        path_.bsdfPdf = context_.how.mixedDensity(ownPdf_, depth);
        path_.beta *= ownPdf_ / path_.bsdfPdf;
    }
    path_.delta = false;
    if (phase.spectral()) {
        const Spectrum ratio = phase.ratio(cosine, path_.lambda);
        checkWeight(ratio, blame);
        path_.beta *= ratio;
    }
    if constexpr (kDispersion) {
        path_.densities.before = path_.densities.unidirectional;
        path_.densities.direction = path_.densities.unidirectional;
    }
    if constexpr (kTraced) {
        meetGatheringInMedium(depth);
        turnTracedInMedium();
    }
    if constexpr (kTextures) scatterCone();
    ray.direction = directionAbout(ray.direction, cosine, sample.bsdf.y);
    ray.kind = RayKind::scattered;
    path_.origin = ray.origin;
    ++counters_.effects.volumes[volumeRow(collided_->number)].scattered;
    return true;
}

// What the path does from here on it does because of the first medium that scattered it.
template <EffectBits E> void PathLoop<E>::touch(const Medium& medium) {
    if (std::exchange(touched_, true)) return;
    ++counters_.effects.volumes[volumeRow(medium.number)].first;
    setWorkCause(static_cast<std::uint8_t>(1 + volumeRow(medium.number)));
}

template <EffectBits E>
void PathLoop<E>::sampleLightInMedium(Vec3 p, Vec3 direction, const VertexSample& sample, std::uint32_t depth) {
    if (!context_.how.asksLights || context_.lights.empty()) return;
    const PickedLight picked = context_.lights.pick(sample.pick, p);
    auto light = picked.light->sample(p, picked.part, sample.light, path_.lambda, path_.time);
    if (!light) return;
    const PhaseFunction& phase = collided_->phase();
    const float cosine = dot(direction, light->wi), value = phase.value(cosine);
    if (value == 0) return;
    ++counters_.shadowRays;
    const Spectrum passing = transmittance(p, *light, {path_.nested.here, {}}, sampler_.stream(2 * depth + 1));
    if (!anyNonZero(passing)) return;
    hideFromScattering(*light, *picked.light, p);
    const float pdf = picked.probability * light->pdfSolidAngle;
    const float weight = askedInMedium(*light, picked, p, context_.how.mixedDensity(value, depth));
    Spectrum contribution = path_.beta * light->radiance * passing * (value * weight / pdf);
    if (phase.spectral()) contribution *= phase.ratio(cosine, path_.lambda);
    checkDensity(pdf);
    checkDensity(value, {collided_, "phase function"});
    gather(contribution * trackingShare(picked), picked.light, false, [&] {
        observer_->asks(picked.light, *light, {Spectrum(value), value}, pdf);
    });
}

} // namespace abbe

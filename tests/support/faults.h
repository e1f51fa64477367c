// Faults on purpose: a material, a light, a medium or a camera of a scene that now and then answers with what is no
// number. Decorators around the real ones; nothing in the renderer knows of them.
#pragma once

#include "render/scene.h"
#include "rendering/path_record.h"
#include "scene/wrapped_materials.h"
#include "support/forwarding_film.h"

#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <unordered_map>

namespace abbe::test {

// Which answer is wrong.
enum class Site : std::uint8_t {
    value,      // of a material
    density,    // beside its value
    weight,     // of its samples
    pdf,        // of its samples
    turn,       // their direction
    opacity,    // of a surface
    radiance,   // of samples of a light
    lightPdf,   // theirs
    lightTurn,  // their direction
    emitted,    // light that is met
    emittedPdf, // the density of having sampled it
    phase,      // value of a phase function
    cosine,     // its samples
    extinction, // density of a medium
    cameraWeight,
    cameraRay,
};

// What is done to one answer in sixteen, chosen by what was asked: the same in every run.
class Injection {
  public:
    static constexpr int kLane = 5;

    // From now on this one, and none so far.
    void inject(Site site, DropCause fault) {
        site_ = site;
        fault_ = fault;
        asked_ = injected_ = 0;
    }
    Site site() const { return site_; }
    DropCause fault() const { return fault_; }
    // Off at first; pilots stay sound, so that they do not differ.
    void arm(bool on) { armed_ = on; }
    std::uint64_t asked() const { return asked_; }
    std::uint64_t injected() const { return injected_; }

    float apply(Site site, float sound, std::initializer_list<float> question) const {
        return strikes(site, question) ? bad(sound) : sound;
    }
    Spectrum apply(Site site, Spectrum sound, std::initializer_list<float> question) const {
        if (strikes(site, question)) sound.v[kLane] = bad(sound[kLane]);
        return sound;
    }
    Vec3 apply(Site site, Vec3 sound, std::initializer_list<float> question) const {
        if (strikes(site, question)) sound.y = bad(sound.y);
        return sound;
    }

  private:
    bool strikes(Site site, std::initializer_list<float> question) const {
        if (site != site_ || !armed_) return false;
        ++asked_;
        std::uint32_t hash = 0x811c9dc5u;
        for (const float v : question)
            hash = (hash ^ std::bit_cast<std::uint32_t>(v)) * 0x01000193u, hash ^= hash >> 15;
        if (((hash * 0x9e3779b1u) >> 28) != 0) return false;
        ++injected_;
        return true;
    }
    float bad(float sound) const {
        if (fault_ == DropCause::nan) return std::numeric_limits<float>::quiet_NaN();
        return fault_ == DropCause::infinite ? kInfinity : -std::max(0.1f * sound, 1e-6f);
    }

    Site site_{};
    DropCause fault_{};
    std::atomic<bool> armed_{false};
    mutable std::atomic<std::uint64_t> asked_{0}, injected_{0};
};

class FaultyBsdf final : public Bsdf {
  public:
    FaultyBsdf(const Bsdf& sound, const Injection& injection) : sound_(sound), injection_(injection) {}
    Lobes lobes() const noexcept override { return sound_.lobes(); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport t) const noexcept override {
        BsdfEval e = sound_.eval(wo, wi, t);
        if (!anyNonZero(e.fcos)) return e;
        e.fcos = injection_.apply(Site::value, e.fcos, {wi.x, wi.y, wi.z});
        e.pdfSolidAngle = injection_.apply(Site::density, e.pdfSolidAngle, {wi.x, wi.y, wi.z});
        return e;
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport t) const noexcept override {
        auto s = sound_.sample(wo, uLobe, u, t);
        if (!s) return s;
        s->weight = injection_.apply(Site::weight, s->weight, {uLobe, u.x, u.y});
        s->pdfSolidAngle = injection_.apply(Site::pdf, s->pdfSolidAngle, {uLobe, u.x, u.y});
        s->wi = injection_.apply(Site::turn, s->wi, {uLobe, u.x, u.y});
        return s;
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override { return sound_.evalDelta(wo, wi); }
    ScatterOutline outline(Vec3 wo) const noexcept override { return sound_.outline(wo); }

  private:
    const Bsdf& sound_;
    const Injection& injection_;
};

class FaultyMaterial final : public ForwardingMaterial {
  public:
    FaultyMaterial(const Material& sound, const Injection& injection)
        : ForwardingMaterial(sound), injection_(injection) {}
    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return arena.make<FaultyBsdf>(*inner_.bsdf(hit, lambda, arena), injection_);
    }
    float opacity(const SurfaceHit& hit) const noexcept override {
        return injection_.apply(Site::opacity, inner_.opacity(hit), {hit.p.x, hit.p.y, hit.p.z});
    }

  private:
    const Injection& injection_;
};

// What is wrong with any light, whatever else it is.
template <typename Kind> class FaultyLightOf : public Kind {
  public:
    FaultyLightOf(std::unique_ptr<const Light> sound, const Injection& injection)
        : sound_(std::move(sound)), injection_(injection) {
        this->setVisible(sound_->visible());
    }
    LightOutput output() const override { return sound_->output(); }
    std::uint32_t parts() const override { return sound_->parts(); }
    std::optional<LightBounds> bounds(std::uint32_t part) const override { return sound_->bounds(part); }
    bool hasNoSurface() const override { return sound_->hasNoSurface(); }
    std::optional<LightReach> reach(const Ray& ray, float tMax) const noexcept override {
        return sound_->reach(ray, tMax);
    }
    const MediumEmission* emission() const override { return sound_->emission(); }
    std::optional<LightSample> sample(const Receiver& from, std::uint32_t part, Vec2 u, const Wavelengths& lambda,
                                      float time) const noexcept override {
        auto s = sound_->sample(from, part, u, lambda, time);
        if (!s) return s;
        s->radiance = injection_.apply(Site::radiance, s->radiance, {u.x, u.y});
        s->pdfSolidAngle = injection_.apply(Site::lightPdf, s->pdfSolidAngle, {u.x, u.y});
        s->wi = injection_.apply(Site::lightTurn, s->wi, {u.x, u.y});
        return s;
    }

  protected:
    const Light& sound() const { return *sound_; }
    const Injection& injection() const { return injection_; }

  private:
    std::unique_ptr<const Light> sound_;
    const Injection& injection_;
};

class FaultySurfaceLight final : public FaultyLightOf<SurfaceLight> {
  public:
    using FaultyLightOf::FaultyLightOf;
    Spectrum emitted(const SurfaceHit& hit, Vec3 w, const Wavelengths& lambda) const noexcept override {
        return injection().apply(Site::emitted, own().emitted(hit, w, lambda), {w.x, w.y, w.z});
    }
    float pdfSolidAngle(const Receiver& from, const SurfaceHit& hit, float time) const noexcept override {
        return injection().apply(Site::emittedPdf, own().pdfSolidAngle(from, hit, time), {hit.p.x, hit.p.y, hit.p.z});
    }
    // No paths start at faulty lights.
    std::optional<LightOrigin> sampleOrigin(std::uint32_t, Vec2, const Wavelengths&, float) const noexcept override {
        return std::nullopt;
    }
    LightOrigin originAt(std::uint32_t, Vec3, Vec3, float) const noexcept override { return {}; }
    Vec3 sampleDirection(const LightOrigin& origin, Vec2) const noexcept override { return origin.n; }
    float pdfDirection(const LightOrigin&, Vec3) const noexcept override { return 0; }
    Spectrum leaving(const LightOrigin&, Vec3, const Wavelengths&) const noexcept override { return Spectrum(0.f); }

  private:
    const SurfaceLight& own() const { return static_cast<const SurfaceLight&>(sound()); }
};

class FaultyDistantLight final : public FaultyLightOf<DistantLight> {
  public:
    using FaultyLightOf::FaultyLightOf;
    bool hasExtent() const override { return sound().infinite(); }
    Spectrum escaped(Vec3 w, const Wavelengths& lambda, float time) const noexcept override {
        return injection().apply(Site::emitted, sound().asDistant()->escaped(w, lambda, time), {w.x, w.y, w.z});
    }
    float pdfEscaped(const Receiver& from, Vec3 w, float time) const noexcept override {
        return injection().apply(Site::emittedPdf, sound().asDistant()->pdfEscaped(from, w, time), {w.x, w.y, w.z});
    }
};

class FaultyPhase final : public PhaseFunction {
  public:
    FaultyPhase(const PhaseFunction& sound, const Injection& injection) : sound_(sound), injection_(injection) {}
    float value(float cosine) const noexcept override {
        return injection_.apply(Site::phase, sound_.value(cosine), {cosine});
    }
    float sampleCosine(float u) const noexcept override {
        return injection_.apply(Site::cosine, sound_.sampleCosine(u), {u});
    }
    bool spectral() const override { return sound_.spectral(); }
    Spectrum ratio(float cosine, const Wavelengths& lambda) const noexcept override {
        return sound_.ratio(cosine, lambda);
    }

  private:
    const PhaseFunction& sound_;
    const Injection& injection_;
};

class FaultyMedium final : public Medium {
  public:
    FaultyMedium(const Medium& sound, const Injection& injection)
        : sound_(sound), injection_(injection), phase_(sound.phase(), injection) {}
    Bounds3 bounds() const override { return sound_.bounds(); }
    MediumWalk* walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept override {
        MediumWalk* sound = sound_.walk(ray, tMax, space);
        if (!sound) return nullptr;
        // Few are under way in a thread at once, and none outlives its ray.
        thread_local std::array<Walk, 16> walks;
        thread_local std::size_t next = 0;
        Walk& walk = walks[next++ % walks.size()];
        walk.sound = sound;
        walk.injection = &injection_;
        walk.origin = ray.origin;
        return &walk;
    }
    const Curve& extinction() const override { return sound_.extinction(); }
    const Curve& albedo() const override { return sound_.albedo(); }
    const PhaseFunction& phase() const override { return phase_; }
    bool albedoVaries() const override { return sound_.albedoVaries(); }
    const MediumEmission* emission() const override { return sound_.emission(); }

  private:
    struct Walk final : MediumWalk {
        bool next(MediumSegment& segment) noexcept override { return sound->next(segment); }
        float density(float t) noexcept override {
            return injection->apply(Site::extinction, sound->density(t), {t, origin.x, origin.y});
        }
        Spectrum albedo(float t, const Wavelengths& lambda) noexcept override { return sound->albedo(t, lambda); }

        MediumWalk* sound = nullptr;
        const Injection* injection = nullptr;
        Vec3 origin;
    };

    const Medium& sound_;
    const Injection& injection_;
    FaultyPhase phase_;
};

class FaultyCamera final : public Camera {
  public:
    FaultyCamera(std::unique_ptr<const Camera> sound, const Injection& injection)
        : sound_(std::move(sound)), injection_(injection) {}
    CameraRay ray(const CameraSample& at) const noexcept override {
        CameraRay ray = sound_->ray(at);
        ray.weight = injection_.apply(Site::cameraWeight, ray.weight, {at.film.x, at.film.y});
        if (ray.weight > 0)
            ray.ray.direction = injection_.apply(Site::cameraRay, ray.ray.direction, {at.film.x, at.film.y});
        return ray;
    }
    bool usesLens() const override { return sound_->usesLens(); }
    bool disperses() const override { return sound_->disperses(); }

  private:
    std::unique_ptr<const Camera> sound_;
    const Injection& injection_;
};

// Shows one material, or one light, as the decorator around it.
class FaultyIntersector final : public Intersector {
  public:
    explicit FaultyIntersector(std::unique_ptr<const Intersector> sound) : sound_(std::move(sound)) {}
    std::unordered_map<const Material*, const Material*> materials;
    std::unordered_map<const Light*, const SurfaceLight*> lights;

    bool intersect(const Ray& ray, SurfaceHit& hit) const noexcept override {
        const bool met = sound_->intersect(ray, hit);
        if (met) replace(hit);
        return met;
    }
    std::size_t coincident(const Ray& ray, const SurfaceHit& hit,
                           std::span<SurfaceHit> others) const noexcept override {
        const std::size_t count = sound_->coincident(ray, hit, others);
        for (SurfaceHit& other : others.first(count)) replace(other);
        return count;
    }
    bool occluded(const Ray& ray) const noexcept override { return sound_->occluded(ray); }
    bool occluded(Vec3 from, Vec3 to, float time, RayKind kind) const noexcept override {
        return sound_->occluded(from, to, time, kind);
    }
    Bounds3 bounds() const override { return sound_->bounds(); }
    std::uint64_t rejectedRays() const override { return sound_->rejectedRays(); }

  private:
    void replace(SurfaceHit& hit) const {
        if (const auto found = materials.find(hit.material); found != materials.end()) hit.material = found->second;
        if (const auto found = lights.find(hit.light); found != lights.end()) hit.light = found->second;
    }

    std::unique_ptr<const Intersector> sound_;
};

// Arms the injection once the pilot, which looks at another film, is done.
class ArmingFilm final : public ForwardingFilm {
  public:
    ArmingFilm(Film& film, Injection& injection) : ForwardingFilm(film), injection_(injection) {}
    std::unique_ptr<SampleRecorder> makeRecorder() override {
        injection_.arm(true);
        return ForwardingFilm::makeRecorder();
    }

  private:
    Injection& injection_;
};

} // namespace abbe::test

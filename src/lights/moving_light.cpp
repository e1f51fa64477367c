#include "lights/moving_light.h"

#include "lights/light_context.h"

namespace abbe {

namespace {

// |A| v
Vec3d absoluteVector(const Transform& m, Vec3d v) {
    const auto row = [&](int i) {
        return std::abs(m.a[i][0]) * v.x + std::abs(m.a[i][1]) * v.y + std::abs(m.a[i][2]) * v.z;
    };
    return {row(0), row(1), row(2)};
}

// To render space. The error bound is that of an instance's hit (geometry/instance.cpp), whose map is rounded to float
// as the one here is not: shadow rays end there.
ShapeSample toRender(const LightPose& pose, const ShapeSample& s) {
    constexpr double rounding = 0x1p-22; // four of float
    const Transform& m = pose.toRender;
    const Vec3d rest(s.p), p = m.point(rest), t = abs(m.t);
    const Vec3d map = absoluteVector(m, abs(rest)) + t;
    const Vec3d ray = absoluteVector(m, absoluteVector(pose.toRest, abs(p) + t));
    const Vec3d error = absoluteVector(m, Vec3d(s.pError)) + (map + ray) * rounding;
    return {Vec3(p), Vec3(error), Vec3(normalize(m.normal(Vec3d(s.ng)))), s.pdfSolidAngle};
}

// A direction, taken to another space.
Vec3 turned(const Transform& m, Vec3 w) { return Vec3(normalize(m.vector(Vec3d(w)))); }

// From rest to render space.
LightOrigin moved(LightOrigin origin, const LightPose& pose) {
    origin.p = Vec3(pose.toRender.point(Vec3d(origin.p)));
    if (origin.point()) return origin;
    origin.n = turned(pose.toRender, origin.n);
    origin.pError = abs(origin.p) * 0x1p-21f;
    origin.pdf *= static_cast<float>(1 / square(pose.scale));
    return origin;
}

} // namespace

std::optional<LightBounds> MovingPlacedLight::bounds(std::uint32_t part) const {
    const auto rest = atRest_->bounds(part);
    return rest ? motion_.swept(*rest) : rest;
}

std::optional<LightBounds> MovingAreaLight::bounds(std::uint32_t part) const {
    const auto rest = AreaLight::bounds(part);
    return rest ? motion_.swept(*rest) : rest;
}

std::optional<LightSample> MovingPlacedLight::sample(const Receiver& from, std::uint32_t part, Vec2 u,
                                                     const Wavelengths& lambda, float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return std::nullopt;
    auto s = atRest_->sample(pose->rest(from), part, u, lambda, time);
    if (!s) return s;
    s->wi = Vec3(normalize(pose->toRender.vector(Vec3d(s->wi))));
    const float scale = static_cast<float>(pose->scale);
    s->p = Vec3(pose->toRender.point(Vec3d(s->p)));
    s->distance *= scale;
    if (atRest_->hasNoSurface())
        s->n = turned(pose->toRender, s->n);
    else
        s->radiance *= 1 / (scale * scale); // intensity / d²
    return s;
}

std::optional<LightSample> MovingDistantLight::sample(const Receiver& from, std::uint32_t part, Vec2 u,
                                                      const Wavelengths& lambda, float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return std::nullopt;
    auto s = atRest_->sample(pose->rest(from), part, u, lambda, time);
    if (s) s->wi = Vec3(normalize(pose->toRender.vector(Vec3d(s->wi))));
    return s;
}

Spectrum MovingDistantLight::escaped(Vec3 w, const Wavelengths& lambda, float time) const noexcept {
    const auto pose = motion_.at(time);
    return pose ? atRest_->escaped(Vec3(normalize(pose->toRest.vector(Vec3d(w)))), lambda, time) : Spectrum(0.f);
}

float MovingDistantLight::pdfEscaped(const Receiver& from, Vec3 w, float time) const noexcept {
    const auto pose = motion_.at(time);
    return pose ? atRest_->pdfEscaped(pose->rest(from), Vec3(normalize(pose->toRest.vector(Vec3d(w)))), time) : 0;
}

std::optional<LightOrigin> MovingPlacedLight::sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths& lambda,
                                                           float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return std::nullopt;
    auto origin = atRest_->sampleOrigin(part, u, lambda, time);
    return origin ? std::optional(moved(*origin, *pose)) : origin;
}

LightOrigin MovingPlacedLight::originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return {};
    return moved(atRest_->originAt(part, pose->rest(p), turned(pose->toRest, n), time), *pose);
}

float MovingPlacedLight::pdfAtPoint(const Receiver& from, std::uint32_t part, Vec3 p, Vec3 n,
                                    float time) const noexcept {
    const auto pose = motion_.at(time);
    return pose ? atRest_->pdfAtPoint(pose->rest(from), part, pose->rest(p), turned(pose->toRest, n), time) : 0;
}

// The light has no surface, or is a beam: what leaves it depends on the direction alone.
Vec3 MovingPlacedLight::sampleDirection(const LightOrigin& origin, Vec2 u) const noexcept {
    const auto pose = motion_.at(origin.time);
    const Vec3 w = atRest_->sampleDirection(origin, u);
    return pose ? turned(pose->toRender, w) : w;
}

float MovingPlacedLight::pdfDirection(const LightOrigin& origin, Vec3 w) const noexcept {
    const auto pose = motion_.at(origin.time);
    return pose ? atRest_->pdfDirection(origin, turned(pose->toRest, w)) : 0;
}

Spectrum MovingPlacedLight::leaving(const LightOrigin& origin, Vec3 w, const Wavelengths& lambda) const noexcept {
    const auto pose = motion_.at(origin.time);
    return pose ? atRest_->leaving(origin, turned(pose->toRest, w), lambda) : Spectrum(0.f);
}

std::optional<LightSample> MovingDistantLight::sampleDistant(Vec2 u, const Wavelengths& lambda,
                                                             float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return std::nullopt;
    auto s = atRest_->sampleDistant(u, lambda, time);
    if (s) s->wi = turned(pose->toRender, s->wi);
    return s;
}

float MovingDistantLight::pdfDistant(Vec3 w, float time) const noexcept {
    const auto pose = motion_.at(time);
    return pose ? atRest_->pdfDistant(turned(pose->toRest, w), time) : 0;
}

std::optional<LightReach> MovingPlacedLight::reach(const Ray& ray, float tMax) const noexcept {
    const auto pose = motion_.at(ray.time);
    if (!pose) return std::nullopt;
    const float scale = static_cast<float>(pose->scale);
    Ray rest = ray;
    rest.origin = pose->rest(ray.origin);
    rest.direction = Vec3(normalize(pose->toRest.vector(Vec3d(ray.direction))));
    auto r = atRest_->reach(rest, tMax / scale);
    if (!r) return r;
    return LightReach{Vec3(pose->toRender.point(Vec3d(r->centre))), r->tNear * scale, std::min(r->tFar * scale, tMax)};
}

std::optional<LightReach> MovingAreaLight::reach(const Ray& ray, float tMax) const noexcept {
    const auto pose = motion_.at(ray.time);
    auto r = AreaLight::reach(ray, tMax);
    if (!pose || !r) return std::nullopt;
    r->centre = Vec3(pose->toRender.point(Vec3d(r->centre)));
    return r;
}

std::optional<LightSample> MovingAreaLight::sample(const Receiver& from, std::uint32_t part, Vec2 u,
                                                   const Wavelengths& lambda, float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return std::nullopt;
    Spectrum factor(1.f);
    const auto s = point(pose->rest(from), part, u, lambda, factor);
    if (!s) return std::nullopt;
    return arriving(toRender(*pose, *s), from.p, lambda, factor);
}

float MovingAreaLight::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit, float time) const noexcept {
    const auto pose = motion_.at(time);
    return pose ? AreaLight::pdfSolidAngle(pose->rest(from), pose->rest(hit), time) : 0;
}

float MovingAreaLight::pdfAtPoint(const Receiver& from, std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return 0;
    const Vec3 normal(normalize(pose->toRest.normal(Vec3d(n))));
    return AreaLight::pdfAtPoint(pose->rest(from), part, pose->rest(p), normal, time);
}

std::optional<LightOrigin> MovingAreaLight::sampleOrigin(std::uint32_t part, Vec2 u, const Wavelengths& lambda,
                                                         float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return std::nullopt;
    auto origin = AreaLight::sampleOrigin(part, u, lambda, time);
    if (!origin) return origin;
    const ShapeSample moved = toRender(*pose, ShapeSample(origin->p, origin->pError, origin->n, origin->pdf));
    origin->p = moved.p;
    origin->pError = moved.pError;
    origin->n = moved.ng;
    origin->pdf *= static_cast<float>(1 / square(pose->scale));
    return origin;
}

LightOrigin MovingAreaLight::originAt(std::uint32_t part, Vec3 p, Vec3 n, float time) const noexcept {
    const auto pose = motion_.at(time);
    if (!pose) return {};
    const Vec3 normal(normalize(pose->toRest.normal(Vec3d(n))));
    LightOrigin origin = AreaLight::originAt(part, pose->rest(p), normal, time);
    origin.p = p;
    origin.n = n;
    origin.pdf *= static_cast<float>(1 / square(pose->scale));
    return origin;
}

std::unique_ptr<Light> inMotion(std::unique_ptr<PlacedLight> light, const LightContext& context) {
    if (!light || !context.motion) return light;
    return std::make_unique<MovingPlacedLight>(std::move(light), *context.motion);
}

std::unique_ptr<Light> inMotion(std::unique_ptr<DistantLight> light, const LightContext& context) {
    if (!light || !context.motion) return light;
    return std::make_unique<MovingDistantLight>(std::move(light), *context.motion);
}

} // namespace abbe

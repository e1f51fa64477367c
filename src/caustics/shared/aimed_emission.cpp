#include "caustics/shared/aimed_emission.h"

#include "base/check.h"
#include "caustics/shared/aim_cone.h"
#include "math/warp.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace abbe {

namespace {

constexpr std::uint32_t kOwn = EmittedRay::kNoTarget;
constexpr std::uint32_t kNowhere = kOwn - 1; // chosen by nobody: directions and places as they are

// Light that leaves one side goes to nothing behind it.
bool behind(const AimTarget& target, const LightOrigin& origin) {
    return origin.sides == LightOrigin::Sides::front && dot(target.centre - origin.p, origin.n) <= -target.radius;
}

// Nothing where the light's own directions are as dense, such as the narrow beam of a spot on a wide target.
std::optional<AimCone> coneOf(const AimTarget& target, const LightOrigin& origin) {
    return AimCone::seen(target, origin.p, static_cast<double>(origin.largest));
}

// Whether there is such a cone that w surely misses.
bool passes(const AimTarget& target, const LightOrigin& origin, Vec3 w) {
    return AimCone::passes(target, origin.p, w, static_cast<double>(origin.largest));
}

// Whether the line through p meets the ball: its middle's distance from the line, in double.
bool crosses(const AimTarget& ball, Vec3 p, Vec3 w) {
    return lengthSquared(cross(Vec3d(ball.centre) - Vec3d(p), Vec3d(w))) <= square(static_cast<double>(ball.radius));
}

double pdfDisk(const AimTarget& ball) { return 1 / (kPiD * square(static_cast<double>(ball.radius))); }

} // namespace

AimedEmission::AimedEmission(const std::vector<std::unique_ptr<const Light>>& lights, const Bounds3& scene,
                             EmissionPlan plan)
    : plan_(std::move(plan)) {
    ABBE_CHECK(plan_.uniformShare > 0 && plan_.uniformShare <= 1);
    ABBE_CHECK(plan_.usefulness.empty() || plan_.usefulness.size() == lights.size());
    const float radius = scene.empty() ? 0 : scene.radius();
    const bool finite = radius > 0 && std::isfinite(radius); // as lights far away have it (lights/light_context.h)
    scene_ = {finite ? scene.centre() : Vec3{}, finite ? radius : 1};
    // Places are rounded, too: as AimCone, the disks are a few steps wider than what they aim at.
    const float steps = 0x1p-21f * (length(scene_.centre) + scene_.radius);
    start_ = scene_.radius;
    for (const AimTarget& target : plan_.targets) {
        ABBE_CHECK(target.radius > 0 && std::isfinite(target.radius) && isFinite(target.centre));
        const float wider = target.radius + steps;
        balls_.push_back(wider < scene_.radius ? AimTarget{target.centre, wider} : scene_);
        start_ = std::max(start_, length(balls_.back().centre - scene_.centre) + balls_.back().radius);
    }
    addAim(lights.size());
    addGrids();
    addLights(lights);
}

void AimedEmission::addAim(std::size_t lights) {
    const std::size_t targets = plan_.targets.size();
    if (plan_.aim.empty()) plan_.aim.assign(targets, 1);
    const std::size_t rows = targets > 0 ? plan_.aim.size() / targets : 1;
    ABBE_CHECK(plan_.aim.size() == rows * targets && (rows == 1 || rows == lights));
    for (std::size_t r = 0; r < rows; ++r) {
        const std::span<const double> aim = std::span(plan_.aim).subspan(r * targets, targets);
        const double sum = std::accumulate(aim.begin(), aim.end(), 0.0);
        const double even = sum > 0 ? static_cast<double>(plan_.uniformShare) : 1;
        std::vector<double> shares{even};
        for (const double a : aim) shares.push_back(sum > 0 ? (1 - even) * a / sum : 0);
        aim_.emplace_back(shares);
    }
}

void AimedEmission::addGrids() {
    if (plan_.parts.empty()) return;
    ABBE_CHECK(plan_.parts.size() == plan_.aim.size());
    for (const std::vector<double>& weights : plan_.parts) {
        const auto row = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(weights.size()))));
        ABBE_CHECK(row * row == weights.size());
        grids_.push_back(weights.empty() ? std::nullopt : std::optional<AimGrid>(std::in_place, weights, row));
    }
}

// Of a target for the lights of a row; null: even.
const AimGrid* AimedEmission::gridOf(std::size_t row, std::uint32_t target) const noexcept {
    if (grids_.empty()) return nullptr;
    const auto& grid = grids_[row * plan_.targets.size() + target];
    return grid ? &*grid : nullptr;
}

void AimedEmission::addLights(const std::vector<std::unique_ptr<const Light>>& lights) {
    std::vector<double> weights;
    double total = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const Light& light = *lights[i];
        if (light.paths() == LightPaths::none) continue;
        Source source{.light = &light,
                      .distant = light.asDistant(),
                      .placed = light.asPlaced(),
                      .parts = {},
                      .row = aim_.size() > 1 ? i : 0};
        if (light.parts() > 1) {
            std::vector<double> parts;
            for (std::uint32_t part = 0; part < light.parts(); ++part) {
                const auto bounds = light.bounds(part);
                parts.push_back(bounds ? static_cast<double>(bounds->power) : 1);
            }
            source.parts.emplace(parts);
        }
        weights.push_back(light.visiblePower() * (plan_.usefulness.empty() ? 1 : plan_.usefulness[i]));
        total += weights.back();
        places_[&light] = sources_.size();
        sources_.push_back(std::move(source));
    }
    if (total > 0) choice_.emplace(weights);
}

std::optional<EmittedRay> AimedEmission::sample(const EmissionNumbers& u, const Wavelengths& lambda,
                                                float time) const noexcept {
    const std::uint32_t chosen = choice_->pick(u.light);
    const Source& source = sources_[chosen];
    const std::uint32_t part = source.parts ? source.parts->pick(u.part) : 0;
    const std::uint32_t bin = aim_[source.row].sample(u.aim).index;
    const std::uint32_t target = bin > 0 ? bin - 1 : kOwn;
    std::optional<EmittedRay> ray = source.distant ? sampleDistant(source, target, u, lambda, time)
                                                   : samplePlaced(source, part, target, u, lambda, time);
    if (!ray) return ray;
    ray->light = source.light;
    ray->part = part;
    ray->density.pick = pickProbability(chosen, part);
    const double total = ray->density.total();
    if (!(total > 0) || !std::isfinite(total)) return std::nullopt;
    ray->beta *= static_cast<float>(1 / total);
    return ray;
}

std::optional<EmittedRay> AimedEmission::samplePlaced(const Source& source, std::uint32_t part, std::uint32_t target,
                                                      const EmissionNumbers& u, const Wavelengths& lambda,
                                                      float time) const noexcept {
    const auto origin = source.placed->sampleOrigin(part, u.position, lambda, time);
    if (!origin) return std::nullopt;
    if (target != kOwn && behind(plan_.targets[target], *origin)) return std::nullopt;
    const auto cone = target == kOwn ? std::nullopt : coneOf(plan_.targets[target], *origin);
    EmittedRay ray;
    if (cone) ray.target = target;
    ray.aim = u.direction;
    if (cone && cone->resolves())
        if (const AimGrid* grid = gridOf(source.row, target)) ray.aim = grid->sample(u.direction);
    const Vec3 w = cone ? cone->sample(ray.aim) : source.placed->sampleDirection(*origin, u.direction);
    ray.beta = source.placed->leaving(*origin, w, lambda) * origin->cosine(w);
    if (!anyNonZero(ray.beta)) return std::nullopt;
    ray.ray.origin = spawnOrigin(origin->p, origin->pError, origin->n, w);
    ray.ray.direction = w;
    ray.ray.time = time;
    ray.n = origin->n;
    ray.density.position = static_cast<double>(origin->pdf);
    ray.density.direction = pdfDirection(source, *origin, w, ray.target);
    ray.deltaPosition = origin->point();
    ray.neverHit = ray.deltaPosition || source.light->neverHit();
    return ray;
}

// Over that of even directions.
double AimedEmission::litDensity(std::size_t row, std::uint32_t target, const AimCone& cone, Vec3 w) const noexcept {
    const AimGrid* grid = gridOf(row, target);
    return grid && cone.resolves() ? grid->density(cone.square(w)) : 1;
}

// The same of the line through p along w, whose frame that is, on the target's disk.
double AimedEmission::litDensity(std::size_t row, std::uint32_t target, Vec3 p, const Frame& frame) const noexcept {
    const AimGrid* grid = gridOf(row, target);
    if (!grid || !resolves(balls_[target])) return 1;
    const Vec3d d = (Vec3d(p) - Vec3d(balls_[target].centre)) / static_cast<double>(balls_[target].radius);
    return grid->density(
        diskToSquare({static_cast<float>(dot(d, Vec3d(frame.x))), static_cast<float>(dot(d, Vec3d(frame.y)))}));
}

// Targets that are too wide leave their share to the light's own distribution. No path is aimed at one behind the
// surface: such a path would only go where unaimed ones do, and be traced for it.
double AimedEmission::pdfDirection(const Source& source, const LightOrigin& origin, Vec3 w,
                                   std::uint32_t chosen) const noexcept {
    const Distribution1D& aim = aim_[source.row];
    double own = aim.probability(0), density = 0;
    for (std::uint32_t t = 0; t < plan_.targets.size(); ++t) {
        const double share = aim.probability(t + 1);
        if (!(share > 0)) continue;
        const AimTarget& target = plan_.targets[t];
        if (t != chosen && (passes(target, origin, w) || behind(target, origin))) continue;
        const auto cone = coneOf(target, origin);
        if (!cone)
            own += share;
        else if (t == chosen || cone->contains(w))
            density += share * cone->pdf() * litDensity(source.row, t, *cone, w);
    }
    return density + own * static_cast<double>(source.placed->pdfDirection(origin, w));
}

std::optional<EmittedRay> AimedEmission::sampleDistant(const Source& source, std::uint32_t target,
                                                       const EmissionNumbers& u, const Wavelengths& lambda,
                                                       float time) const noexcept {
    const auto s = source.distant->sampleDistant(u.direction, lambda, time);
    if (!s || !anyNonZero(s->radiance)) return std::nullopt;
    const AimTarget& ball = target == kOwn ? scene_ : balls_[target];
    const Vec3 w = -s->wi;
    const Frame frame = Frame::fromNormal(w);
    EmittedRay ray;
    ray.aim = u.position;
    if (target != kOwn && resolves(ball))
        if (const AimGrid* grid = gridOf(source.row, target)) ray.aim = grid->sample(u.position);
    const Vec2 q = squareToDisk(ray.aim) * ball.radius;
    const Vec3d p =
        Vec3d(ball.centre) + Vec3d(frame.x) * static_cast<double>(q.x) + Vec3d(frame.y) * static_cast<double>(q.y);
    const double back = static_cast<double>(start_) + dot(p - Vec3d(scene_.centre), Vec3d(w));
    ray.target = target;
    ray.beta = s->radiance;
    ray.ray.origin = Vec3(p - Vec3d(w) * back);
    ray.ray.direction = w;
    ray.ray.time = time;
    ray.density.distant = true;
    ray.density.position = pdfPosition(source, ray.ray.origin, w, target);
    ray.density.direction = s->delta ? 1 : static_cast<double>(s->pdfSolidAngle);
    ray.deltaDirection = s->delta;
    ray.neverHit = s->delta || source.light->neverHit();
    return ray;
}

double AimedEmission::pdfPosition(const Source& source, Vec3 p, Vec3 w, std::uint32_t chosen) const noexcept {
    const Distribution1D& aim = aim_[source.row];
    const Frame frame = Frame::fromNormal(w);
    double density = chosen == kOwn || crosses(scene_, p, w) ? aim.probability(0) * pdfDisk(scene_) : 0;
    for (std::uint32_t t = 0; t < balls_.size(); ++t) {
        const double share = aim.probability(t + 1);
        if (share > 0 && (t == chosen || crosses(balls_[t], p, w)))
            density += share * pdfDisk(balls_[t]) * (grids_.empty() ? 1 : litDensity(source.row, t, p, frame));
    }
    return density;
}

double AimedEmission::pickProbability(std::size_t source, std::uint32_t part) const noexcept {
    const auto& parts = sources_[source].parts;
    return choice_->probability(source) * (parts ? parts->probability(part) : 1);
}

EmissionDensity AimedEmission::density(const Light* light, std::uint32_t part, Vec3 p, Vec3 n, Vec3 w,
                                       float time) const noexcept {
    const auto place = places_.find(light);
    const PlacedLight* const placed = !empty() && place != places_.end() ? sources_[place->second].placed : nullptr;
    if (!placed) return {};
    const LightOrigin origin = placed->originAt(part, p, n, time);
    EmissionDensity result;
    result.pick = pickProbability(place->second, part);
    result.position = static_cast<double>(origin.pdf);
    result.direction = pdfDirection(sources_[place->second], origin, w, kNowhere);
    return result;
}

EmissionDensity AimedEmission::density(const Light* light, Vec3 p, Vec3 w, float time) const noexcept {
    const auto place = places_.find(light);
    const DistantLight* const distant = !empty() && place != places_.end() ? sources_[place->second].distant : nullptr;
    if (!distant) return {};
    EmissionDensity result;
    result.distant = true;
    result.pick = pickProbability(place->second, 0);
    result.direction = distant->hasExtent() ? static_cast<double>(distant->pdfDistant(-w, time)) : 1;
    // What lies before the start is never reached: a shape without an end can.
    const float ahead = dot(p - scene_.centre, w);
    if (ahead >= -start_ * (1 + 0x1p-20f)) result.position = pdfPosition(sources_[place->second], p, w, kNowhere);
    return result;
}

} // namespace abbe

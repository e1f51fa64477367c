#include "caustics/manifold/chain_tracer.h"

#include "transport/surroundings.h"

namespace abbe {

namespace {

constexpr int kMaxCrossings = 64; // of boundaries and openings on the way to one vertex

} // namespace

Spectrum ChainTracer::clearness(const Surroundings& here, const SurfaceHit* end, const Ray& ray, float distance) const {
    Spectrum clear(1.f);
    const Curve* absorption = here.absorption();
    // What is left without having been entered was there from the start (PathWalk::absorb).
    if (end && !here.filling() && dot(ray.direction, end->ng) > 0) absorption = end->material->absorption();
    if (absorption && distance < kInfinity) clear = exp(absorption->at(lambda_) * -distance);
    return media_ ? clear * media_->transmittance(ray, distance, here.media(), lambda_, *random_) : clear;
}

// The share of the light that goes straight on, which has then crossed the surface.
float ChainTracer::straightOn(SurfaceHit& hit, const Ray& ray, Surroundings& here, Surroundings& beyond) const {
    const Material& material = *hit.material;
    if (material.isBoundary()) {
        here.cross(hit, ray.direction);
        return 1;
    }
    if (material.mayBeOpen()) return 1 - material.opacity(hit);
    if (material.ior()) {
        if (!isHiddenFace(scene_, hit, ray, here, beyond)) return 0;
        here = beyond;
        return 1;
    }
    hit.outside = here.ior();
    beyond = here;
    beyond.cross(hit, ray.direction);
    return 0;
}

bool ChainTracer::intersect(Vec3 spawn, Vec3d direction, Surroundings& here, Surroundings& beyond, ChainVertex& v) {
    Ray ray{spawn, normalize(Vec3(direction)), kInfinity, start_.time};
    v.clearness = Spectrum(1.f);
    for (int crossings = 0; crossings < kMaxCrossings; ++crossings) {
        ++rays_;
        if (!scene_.intersector->intersect(ray, v.hit)) return false;
        v.hit.arrival = ray.direction;
        v.hit.footprint = 0;
        v.hit.outside = nullptr;
        v.clearness *= clearness(here, &v.hit, ray, v.hit.distance);
        const float share = straightOn(v.hit, ray, here, beyond);
        if (!(share > 0)) {
            v.in = direction;
            return followed_.contains(v.hit.shape);
        }
        v.clearness *= share;
        ray.origin = spawnOrigin(v.hit, ray.direction);
    }
    return false;
}

// Mirrors or refracts the ray at the patch, and its neighbours with it [Igehy1999].
bool ChainTracer::turn(ChainEvent event, const SurfacePatch& patch, ChainVertex& v, Beam& beam) const {
    const Vec3d d = v.in;
    v.p = patch.p;
    const double across = dot(d, patch.ng);
    const double side = dot(d, patch.n) > 0 ? -1 : 1; // n against the ray
    const Vec3d n = patch.n * side;
    const double c = -dot(d, n);
    if (!(c > 0) || across == 0) return false;
    double ratio = 1; // index before over index beyond
    if (event == ChainEvent::transmission) {
        const Curve* inside = v.hit.material->ior();
        if (inside) {
            Spectrum index = inside->at(lambda_);
            if (v.hit.outside) index = index / v.hit.outside->at(lambda_);
            ratio = side > 0 ? 1 / static_cast<double>(index[0]) : static_cast<double>(index[0]);
        }
    }
    const double k = 1 - ratio * ratio * (1 - c) * (1 + c);
    if (!(k > 0)) return false; // total reflection
    const double beyond = std::sqrt(k), bend = ratio * c - beyond;
    v.out = event == ChainEvent::reflection ? d + n * (2 * c) : d * ratio + n * bend;
    v.out = normalize(v.out);
    // Shading normals neither open a surface nor close it.
    const bool through = dot(v.out, patch.ng) * across > 0;
    if (through != (event == ChainEvent::transmission)) return false;
    for (std::size_t i = 0; i < 2; ++i) {
        Vec3d& p = beam.p[i];
        Vec3d& dd = beam.d[i];
        p = p - d * (dot(p, patch.ng) / across); // along the ray onto the surface
        const Vec3d dn = patch.normalChange(p) * side;
        const double dc = -(dot(dd, n) + dot(d, dn));
        if (event == ChainEvent::reflection)
            dd = dd + (dn * c + n * dc) * 2.0;
        else
            dd = dd * ratio + dn * bend + n * ((ratio - ratio * ratio * c / beyond) * dc);
    }
    return true;
}

void ChainTracer::aim(const Beam& beam, SpecularChain& chain) const {
    const ChainVertex& last = chain.last();
    Vec3d towards(target_.direction);
    chain.spread2 = 1;
    double nearness = 0; // 1/m
    if (!target_.distant) {
        const Vec3d way = Vec3d(target_.origin.p) - last.p;
        chain.spread2 = lengthSquared(way);
        nearness = 1 / std::sqrt(chain.spread2);
        towards = way * nearness;
    } else {
        towards = normalize(towards);
    }
    const auto [x, y] = tangentsOf(towards);
    // Stereographic: it grows all the way to the opposite direction.
    const double scale = 2 / (1 + std::max(dot(last.out, towards), -1 + 1e-12));
    chain.miss = {scale * dot(last.out, x), scale * dot(last.out, y)};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vec3d turned = beam.d[i] + (beam.p[i] - towards * dot(beam.p[i], towards)) * nearness;
        chain.jacobian[0][i] = dot(turned, x);
        chain.jacobian[1][i] = dot(turned, y);
    }
}

bool ChainTracer::trace(Vec3d direction, ChainSignature signature, const Shape* first, SpecularChain& chain) {
    chain.direction = direction;
    chain.length = signature.length();
    const auto [x, y] = tangentsOf(direction);
    Beam beam{{}, {x, y}};
    Vec3d p(start_.receiver.p), d = direction;
    Vec3 spawn = spawnOrigin(start_.receiver.p, start_.pError, start_.ng, Vec3(d));
    Surroundings here = start_.around, beyond;
    for (int i = 0; i < chain.length; ++i) {
        ChainVertex& v = chain.vertices[static_cast<std::size_t>(i)];
        if (!intersect(spawn, d, here, beyond, v) || (i == 0 && v.hit.shape != first)) return false;
        const auto patch = v.hit.shape->patch(v.hit, p, d);
        if (!patch) return false;
        const double distance = dot(patch->p - p, d);
        if (!(distance > 0)) return false;
        for (std::size_t k = 0; k < 2; ++k) beam.p[k] = beam.p[k] + beam.d[k] * distance;
        if (!turn(signature[i], *patch, v, beam)) return false;
        if (signature[i] == ChainEvent::transmission) here = beyond;
        p = v.p;
        d = v.out;
        spawn = spawnOrigin(v.hit, Vec3(d));
    }
    behind_ = here;
    aim(beam, chain);
    return true;
}

bool ChainTracer::reachesLight(SpecularChain& chain) {
    const ChainVertex& last = chain.last();
    const Vec3 out(last.out);
    Ray ray{spawnOrigin(last.hit, out), normalize(out), kInfinity, start_.time};
    Vec3 end;
    if (!target_.distant) {
        const LightOrigin& origin = target_.origin;
        // As for shadow rays: the end is as uncertain as the direction (AreaLight::sample).
        const float rounding = 0x1p-21f * std::sqrt(static_cast<float>(chain.spread2));
        end = spawnOrigin(origin.p, origin.pError + Vec3{rounding, rounding, rounding}, origin.n, -out);
    }
    chain.clearness = Spectrum(1.f);
    Surroundings here = behind_, beyond;
    SurfaceHit hit;
    const Intersector& world = *scene_.intersector;
    for (int crossings = 0; crossings < kMaxCrossings; ++crossings) {
        if (!target_.distant) {
            const Vec3 way = end - ray.origin;
            ray.tMax = length(way);
            if (!(ray.tMax > 0)) return true;
            ray.direction = way / ray.tMax;
        }
        ++rays_;
        if (!scene_.boundaries) {
            if (target_.distant ? world.occluded(ray) : world.occluded(ray.origin, end, start_.time)) return false;
        }
        if (!scene_.boundaries || !world.intersect(ray, hit) || !(hit.distance < ray.tMax)) {
            chain.clearness *= clearness(here, nullptr, ray, ray.tMax);
            return true;
        }
        hit.arrival = ray.direction;
        hit.footprint = 0;
        chain.clearness *= clearness(here, &hit, ray, hit.distance);
        const float share = straightOn(hit, ray, here, beyond);
        if (!(share > 0)) return false;
        chain.clearness *= share;
        ray.origin = spawnOrigin(hit, ray.direction);
    }
    return false;
}

namespace {

bool isSingular(const SpecularChain& chain) {
    double size = 0;
    for (const auto& row : chain.jacobian) size += square(row[0]) + square(row[1]);
    return !(std::abs(chain.determinant()) > ChainSolver::kSingular * size); // NaN is
}

} // namespace

// One step that comes closer; false if there is none.
bool ChainSolver::step(ChainSignature signature, const Shape* first) {
    const SpecularChain& here = chains_[current_];
    const auto& j = here.jacobian;
    const double scale = -1 / here.determinant();
    Vec2d s{(j[1][1] * here.miss.x - j[0][1] * here.miss.y) * scale,
            (j[0][0] * here.miss.y - j[1][0] * here.miss.x) * scale};
    const double size = std::hypot(s.x, s.y);
    if (!std::isfinite(size)) return false;
    if (size > reach_) s = s * (reach_ / size);
    const auto [x, y] = tangentsOf(here.direction);
    const std::size_t other = 1 - current_;
    for (int halvings = 0; halvings < kMaxHalvings; ++halvings, s = s * 0.5) {
        const Vec3d next = normalize(here.direction + x * s.x + y * s.y);
        if (!tracer_.trace(next, signature, first, chains_[other])) continue;
        if (!(chains_[other].miss2() < here.miss2())) continue;
        current_ = other;
        return true;
    }
    return false;
}

const SpecularChain* ChainSolver::solve(Vec3d direction, ChainSignature signature, const Shape* first) {
    if (!tracer_.trace(direction, signature, first, chains_[current_])) return nullptr;
    for (int i = 0; i < kMaxIterations; ++i) {
        const SpecularChain& here = chains_[current_];
        if (isSingular(here)) return nullptr;
        if (here.miss2() < square(kTolerance)) return &here;
        ++iterations_;
        if (!step(signature, first)) return nullptr;
    }
    return nullptr;
}

} // namespace abbe

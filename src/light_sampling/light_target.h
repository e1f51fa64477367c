// A point of a light, or a direction to one far away, that chains of delta interfaces are to lead to.
#pragma once

#include "light_sampling/emitted_ray.h"
#include "render/light.h"

#include <cmath>
#include <optional>

namespace abbe {

// Render space.
struct LightTarget {
    const Light* light = nullptr;
    const PlacedLight* placed = nullptr; // the same, unless it is distant
    LightOrigin origin;                  // of a light at a place
    bool distant = false;                // otherwise what follows:
    Vec3 direction;                      // unit, towards the light
    Spectrum radiance{0.f};              // from there; irradiance if the light is a single direction
    bool delta = false;                  // of a single point or direction, or of a beam: no path meets it by chance
    // 1/m² of origin.p or 1/sr of the direction, with the probability of the light's part; deltas count as 1.
    float pdf = 0;
    float pick = 1; // probability of the light

    // Of a part of a light, drawn by `u` in [0, 1)²; parts are drawn alike, the light was with probability `pick`.
    // Nothing where no light leaves.
    static std::optional<LightTarget> sample(const Light& light, std::uint32_t part, float pick, Vec2 u,
                                             const Wavelengths& lambda, float time) noexcept {
        LightTarget target;
        target.light = &light;
        target.pick = pick;
        if (const DistantLight* const far = light.asDistant()) {
            const auto s = far->sampleDistant(u, lambda, time);
            if (!s) return std::nullopt;
            target.distant = true;
            target.delta = s->delta || light.unmet();
            target.direction = s->wi;
            target.radiance = s->radiance;
            target.pdf = s->pdfSolidAngle;
        } else {
            target.placed = light.asPlaced();
            if (!target.placed) return std::nullopt;
            const auto origin = target.placed->sampleOrigin(part, u, lambda, time);
            if (!origin) return std::nullopt;
            target.takeOrigin(*origin);
        }
        if (!(target.pdf > 0) || !std::isfinite(target.pdf)) return std::nullopt;
        return target;
    }
    // The same for a point of an area light that a path has met, without what it gives off.
    static LightTarget met(const SurfaceHit& hit, float time) noexcept {
        LightTarget target;
        target.light = target.placed = hit.light;
        target.takeOrigin(hit.light->originAt(hit.light->partOf(hit), hit.p, hit.ng, time));
        return target;
    }
    // And for a direction in which a path left the scene.
    static LightTarget met(const DistantLight& light, Vec3 w, float time) noexcept {
        LightTarget target;
        target.light = &light;
        target.distant = true;
        target.direction = w;
        target.pdf = light.pdfDistant(w, time);
        return target;
    }

    // And for where a light path began, of a light that has an extent.
    static LightTarget begun(const EmittedRay& start, float time) noexcept {
        if (start.density.distant) return met(*start.light->asDistant(), -start.ray.direction, time);
        LightTarget target;
        target.light = start.light;
        target.placed = start.light->asPlaced();
        target.takeOrigin(target.placed->originAt(start.part, start.ray.origin, start.n, time));
        return target;
    }

    // Of light that leaves in the unit direction w: radiance times the cosine at the light, intensity of a point, or
    // what arrives from far away.
    Spectrum leaving(Vec3 w, const Wavelengths& lambda) const noexcept {
        return distant ? radiance : placed->leaving(origin, w, lambda) * origin.cosine(w);
    }

  private:
    void takeOrigin(const LightOrigin& o) {
        origin = o;
        delta = o.point() || light->unmet();
        pdf = o.pdf / static_cast<float>(light->parts());
    }
};

} // namespace abbe

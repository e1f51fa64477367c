// Where light paths start: the first segment of one with its densities, and points of lights that chains are to lead
// to.
#pragma once

#include "render/light.h"
#include "render/ray.h"

#include <cmath>
#include <cstdint>
#include <optional>

namespace abbe {

// How likely a path of light starts as it does: the densities of the steps that make its first two vertices, y0 on the
// light and y1 where it arrives, as multiple importance sampling needs them [Veach1997, sec. 8.2 and 10.2]. 0 where it
// cannot start like that.
struct EmissionDensity {
    double pick = 0;     // probability of the light and its part
    double position = 0; // 1/m²: of y0 on the light's surface, or 1 at a light that is a point; for lights far away of
                         // the line, across its direction
    double direction = 0; // 1/sr, or 1 for a light in a single direction
    bool distant = false; // y0 is infinitely far away

    double total() const { return pick * position * direction; }
    // Of y0: 1/m² on the light, or 1/sr for a light far away, what Light::sample() is to be compared with.
    double atLight() const { return pick * (distant ? direction : position); }
    // Of y1 given y0, 1/m² on its surface: `cosine` is that at y1, `distance2` m² (lights far away need none).
    double arriving(double cosine, double distance2) const {
        return std::abs(cosine) * (distant ? position : direction / distance2);
    }
};

// The first segment of a path of light.
struct EmittedRay {
    static constexpr std::uint32_t kNoTarget = 0xffffffffu;

    const Light* light = nullptr;
    std::uint32_t part = 0;
    std::uint32_t target = kNoTarget; // which of the plan's it was aimed at
    // Free of the light's own surface. From far away it starts where all finite geometry and all targets still lie
    // ahead: only shapes without an end may shade it there, which a ray backwards tells.
    Ray ray;
    Vec2 aim;      // where in the square of that target's cone or disk (AimGrid)
    Vec3 n;        // unit normal of the light's surface, outside; 0 where it has none
    Spectrum beta; // W·nm⁻¹: radiance cos θ / density. Its mean over rays is the power of all lights
    EmissionDensity density;
    bool deltaPosition = false, deltaDirection = false;
    bool neverHit = false; // a camera path cannot hit the light, as it is one of these or has no body
};

// A point of a light, or a direction to one far away, that chains of delta interfaces are to lead to. Render space.
struct LightTarget {
    const Light* light = nullptr;
    const PlacedLight* placed = nullptr; // the same, unless it is distant
    LightOrigin origin;                  // of a light at a place
    bool distant = false;                // otherwise what follows:
    Vec3 direction;                      // unit, towards the light
    Spectrum radiance{0.f};              // from there; irradiance if the light is a single direction
    bool delta = false;                  // of a single point or direction, or of a beam: no path hits it by chance
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
            target.delta = s->delta || light.neverHit();
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
    // The same for a point of an area light that a path has hit, without what it gives off.
    static LightTarget ofHit(const SurfaceHit& hit, float time) noexcept {
        LightTarget target;
        target.light = target.placed = hit.light;
        target.takeOrigin(hit.light->originAt(hit.light->partOf(hit), hit.p, hit.ng, time));
        return target;
    }
    // And for a direction in which a path left the scene.
    static LightTarget ofHit(const DistantLight& light, Vec3 w, float time) noexcept {
        LightTarget target;
        target.light = &light;
        target.distant = true;
        target.direction = w;
        target.pdf = light.pdfDistant(w, time);
        return target;
    }

    // And for where a light path began, of a light that has an extent.
    static LightTarget begun(const EmittedRay& start, float time) noexcept {
        if (start.density.distant) return ofHit(*start.light->asDistant(), -start.ray.direction, time);
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
        delta = o.point() || light->neverHit();
        pdf = o.pdf / static_cast<float>(light->parts());
    }
};

} // namespace abbe

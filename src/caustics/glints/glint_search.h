// Camera paths over delta interfaces, for who looks for glints before a render.
#pragma once

#include "caustics/shared/chain_signature.h"
#include "render/light.h"
#include "render/surface_hit.h"
#include "spectrum/spectrum.h"

#include <optional>

namespace abbe {

// A segment behind the first event.
struct GlintView {
    const ChainSignature& chain; // so far
    Vec3 p, direction;           // where it starts, and where to, unit
    Spectrum throughput;         // radiance at the eye over that of what is seen here, per lane
    double probability;          // with which a camera path would have taken these events
    const SurfaceHit* hit;       // where it ends; null: nowhere
    float time = 0;              // as Ray::time

    // What a lamp gives in this direction, if it is what is seen.
    Spectrum emitted(const Light& light, const Wavelengths& lambda) const {
        if (hit) return hit->light == &light ? hit->light->emitted(*hit, -direction, lambda) : Spectrum(0.f);
        const DistantLight* const distant = light.asDistant();
        return distant && distant->hasExtent() ? distant->escaped(direction, lambda, time) : Spectrum(0.f);
    }
};

struct GlintQuery {
    Vec2 film;                           // as CameraSample::film
    float wavelength = 0.5f;             // of the hero, as WavelengthDensity::sample() takes it
    std::optional<ChainSignature> chain; // which events to take; without them they are drawn, either alike
    std::uint64_t seed = 0;              // for that, and for the place on the lens and the time
};

} // namespace abbe

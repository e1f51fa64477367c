// How a light moves while the shutter is open.
#pragma once

#include "math/motion.h"
#include "render/light_bounds.h"
#include "render/receiver.h"
#include "render/surface_hit.h"

#include <optional>

namespace abbe {

// Between rest, which is render space at the time when the shutter opens, and render space at another time.
struct LightPose {
    Transform toRender, toRest;
    double scale = 1; // from rest to render space

    Vec3 rest(Vec3 p) const { return Vec3(toRest.point(Vec3d(p))); }
    Receiver rest(const Receiver&) const;
    SurfaceHit rest(const SurfaceHit&) const; // point and geometric normal
};

// Rigid, or with one scale for all directions: solid angles are then those at rest, and so are densities over them.
class LightMotion {
  public:
    // `fromRest` is the identity when the interval begins. Requires keepsShape().
    LightMotion(Motion fromRest, Interval shutter) : fromRest_(std::move(fromRest)), shutter_(shutter) {}

    // Whether a light can follow this motion: it keeps its shape and does not turn inside out. Looked for at 65 times.
    static bool keepsShape(const Motion& fromRest, Interval shutter);

    // What bounds a light at all times, from what bounds it at rest; nothing where that cannot be known. The power is
    // that at rest.
    std::optional<LightBounds> swept(const LightBounds& rest) const;
    // At a Ray::time; nothing where the scale comes so near to 0 that there is no way back.
    std::optional<LightPose> at(float time) const;

  private:
    Motion fromRest_;
    Interval shutter_;
};

} // namespace abbe

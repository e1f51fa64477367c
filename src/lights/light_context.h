// What making a light needs besides its own parameters: the scene around it, and how it moves.
#pragma once

#include "base/source.h"
#include "math/bounds.h"
#include "math/motion.h"
#include "render/kept_tables.h"
#include "render/light.h"
#include "render/receiver.h"
#include "render/surface_hit.h"
#include "spectrum/curve.h"

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

// How a light moves while the shutter is open. Rigid, or with one scale for all directions: solid angles are then those
// at rest, and so are densities over them.
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

class Texture;

// What the maker of a light is given.
struct LightContext {
    Transform toRender;                  // from the space of the light's parent; its own `transform` comes first
    const Curve* defaultColor = nullptr; // illuminant D65, any scale; lives as long as the light
    Span span;                           // of the definition's head
    bool zUp = false;                    // what `elevation`, `azimuth` and an environment's poles refer to
    double time = 0;                     // s, for which it is made: when the shutter opens
    bool besideScattering = true;        // whether samples may leave out what scattering finds as well
    const LightMotion* motion = nullptr; // null: it stands still; read while the light is made
    // Area lights with a texture, ready for TextureUse::light; all null or unused without one.
    const Texture* texture = nullptr;
    const Curve* textureWhite = nullptr; // radiance where the texture is 1, if that is all the scene says of it
    Transform toOwn = {};                // from render space to that of the light, before its transform
    KeptTables* kept = nullptr;          // null: none are kept
    bool texturesOpen = true;            // false: the scene is only checked, and nothing can be looked up
};

// A curve by its values, from one nanometre to the next over all that is rendered.
inline void addCurve(DigestWriter& writer, const Curve& curve) {
    for (double nm = 360; nm <= 830; ++nm) writer.number(curve.at(nm));
}

// The cross-section that the finite geometry offers to light from far away. m². Scenes without finite geometry (planes
// alone) get that of a sphere of 1 m, so that no distant light counts for nothing.
inline double sceneDiskArea(const Bounds3& bounds) {
    const double radius = bounds.empty() ? 0 : bounds.radius();
    return kPiD * (radius > 0 && std::isfinite(radius) ? square(radius) : 1);
}

} // namespace abbe

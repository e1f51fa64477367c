// What making a light needs besides its own parameters.
#pragma once

#include "base/source.h"
#include "lights/light_motion.h"
#include "spectrum/curve.h"

namespace abbe {

class Texture;

struct LightContext {
    Transform toRender;                  // from the space of the light's parent; its own `transform` comes first
    const Curve* defaultColor = nullptr; // illuminant D65, any scale; lives as long as the light
    Span span;                           // of the definition's head
    bool zUp = false;                    // what `elevation`, `azimuth` and an environment's poles refer to
    double time = 0;                     // s, for which it is made: when the shutter opens
    const LightMotion* motion = nullptr; // null: it stands still; read while the light is made
    // Area lights with a texture, ready for TextureUse::light; all null or unused without one.
    const Texture* texture = nullptr;
    const Curve* textureWhite = nullptr; // radiance where the texture is 1, if that is all the scene says of it
    Transform toOwn = {};                // from render space to that of the light, before its transform
    bool texturesOpen = true;            // false: the scene is only checked, and nothing can be looked up
};

} // namespace abbe

// What making a light needs besides its own parameters.
#pragma once

#include "base/source.h"
#include "math/transform.h"
#include "spectrum/curve.h"

namespace abbe {

struct LightContext {
    Transform toRender;                  // from the space of the light's parent; its own `transform` comes first
    const Curve* defaultColor = nullptr; // illuminant D65, any scale; lives as long as the light
    Span span;                           // of the definition's head
    bool zUp = false;                    // what `elevation`, `azimuth` and an environment's poles refer to
};

} // namespace abbe

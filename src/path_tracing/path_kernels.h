// The kernels of a path tracer: functions that exist once for each of these sets of effects. All are always built, so
// that none rots.
#pragma once

#include "caustics/shared/kernel_jobs.h"
#include "render/effects.h"

namespace abbe {

struct Kernel {
    Effects effects;
    const char* name; // for people
    TileFunction render;
    const LightPathKernel& lightPaths; // of at least the same effects
};

// The cheapest that has these effects; the largest that this build has (kCompiledEffects) if none does.
const Kernel& kernelFor(Effects);

// Beside light paths: of scenes without media, and of all.
extern const LightPathKernel kInterfacesWithLightPaths, kAllWithLightPaths;

} // namespace abbe

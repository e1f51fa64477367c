// What is said of paths that go on and on.
#pragma once

#include "base/diagnostic.h"
#include "render/integrator.h"
#include "scene/build.h"

namespace abbe {

// Before the first sample: between which shapes paths go round that lose no light there. `samples` of each pixel are
// wanted; 0: as many as there is time for.
void warnOfEndlessPaths(const FirstLook&, const BuiltScene&, double samples, Diagnostics&);
// Of those that met the safety cap on vertices, with the shapes and media where they did.
void warnOfCappedPaths(const RenderStatistics&, const BuiltScene&, Diagnostics&);

} // namespace abbe

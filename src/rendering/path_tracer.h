// The path tracer: next-event estimation and BSDF sampling joined by multiple importance sampling.
#pragma once

#include "render/integrator.h"
#include "render/scene.h"

#include <memory>

namespace abbe {

// The smallest instantiation of the path loop that holds `required`; every larger one renders the same bits.
std::unique_ptr<const Integrator> makePathTracer(Effects required);

} // namespace abbe

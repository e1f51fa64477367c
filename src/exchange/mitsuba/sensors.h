// Sensors, films, filters, samplers and integrators of Mitsuba's as camera, film and render.
#pragma once

#include "exchange/mitsuba/context.h"

namespace abbe::exchange {

// All sensors become cameras; film and sampler are those of the first.
void convertSensors(const std::vector<const XmlObject*>&, MitsubaContext&);

// What the integrator is, for all that follows.
void readIntegrator(const XmlObject&, MitsubaContext&);

} // namespace abbe::exchange

// What stands at the top of Mitsuba's scenes beside shapes: emitters as lights; sensors, films, filters, samplers and
// integrators as camera, film and render.
#pragma once

#include "exchange/mitsuba/textures.h"

namespace abbe::exchange {

// Of a shape: its emission.
void writeShapeEmitter(SceneNode& shapeNode, const XmlObject& emitter, const XmlObject& shape, MitsubaContext&);
// Textures of the light need the coordinates of the shape, too.
void noteEmitterTextures(const XmlObject& emitter, MaterialTraits&);
// Of the scene.
void convertEmitter(const XmlObject&, MitsubaContext&);

// All sensors become cameras; film and sampler are those of the first.
void convertSensors(const std::vector<const XmlObject*>&, MitsubaContext&);
// What the integrator is, for all that follows.
void readIntegrator(const XmlObject&, MitsubaContext&);

} // namespace abbe::exchange

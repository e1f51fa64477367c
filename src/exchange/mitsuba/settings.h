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
// sunsky, and sky and sun of older versions (sunsky.cpp).
void convertSky(const XmlObject&, MitsubaContext&);
// `visible-to` of a light, where the integrator hides emitters from the camera. `placed`: it is no light all around.
void hideFromCamera(SceneNode& light, bool placed, const MitsubaContext&);

// All sensors become cameras; film and sampler are those of the first.
void convertSensors(std::vector<const XmlObject*>, MitsubaContext&);
// Full angle in degrees across the width of a picture of that aspect, of a sensor or projector.
double horizontalFov(const XmlObject&, double aspect, MitsubaContext&);
// What the integrator is, for all that follows.
void readIntegrator(const XmlObject&, MitsubaContext&);

} // namespace abbe::exchange

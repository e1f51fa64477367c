// Emitters of Mitsuba's as lights.
#pragma once

#include "exchange/mitsuba/textures.h"

namespace abbe::exchange {

// Of a shape: its emission.
void writeShapeEmitter(SceneNode& shapeNode, const XmlObject& emitter, const XmlObject& shape, MitsubaContext&);
// Textures of the light need the coordinates of the shape, too.
void noteEmitterTextures(const XmlObject& emitter, MaterialTraits&);
// Of the scene.
void convertEmitter(const XmlObject&, MitsubaContext&);

} // namespace abbe::exchange

// Marks a lookup of a texture.
#pragma once

#include "base/work.h"

namespace abbe {

// Around one lookup of a material or a light, whatever textures that one is made of.
class TextureWork : public WorkScope {
  public:
    TextureWork() : WorkScope(Work::textures) { ++workState.textureLookups; }
};

} // namespace abbe

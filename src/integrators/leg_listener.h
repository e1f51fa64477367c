// Hears where a path goes.
#pragma once

#include "render/ray.h"

namespace abbe {

class LegListener {
  public:
    // Of a straight way up to a surface, a boundary of a medium or the end of everything, before the path is followed
    // to where it collides with a medium.
    virtual void goes(const Ray&, float tMax) = 0;

  protected:
    ~LegListener() = default;
};

} // namespace abbe

// The axes of an OpenPBR coat, where it has a normal or a tangent of its own.
#pragma once

#include "materials/openpbr.h"
#include "math/frame.h"
#include "render/surface_hit.h"

#include <optional>

namespace abbe {

// Immutable. Refers to the textures of the parameters.
class OpenPbrCoatFrame {
  public:
    explicit OpenPbrCoatFrame(const OpenPbrParams&);

    // Whether at() looks at the parametrisation of the hit.
    bool usesTextures() const { return ownNormal() || tangent_.texture || tangent_.value != 0 || baseTurned_; }
    // In hit.shading's axes; nothing where they are the same. Requires the parametrisation if usesTextures().
    std::optional<Frame> at(const SurfaceHit& hit) const;

  private:
    bool ownNormal() const { return normal_.texture || normal_.value < 1; }
    Vec3 normal(const SurfaceHit& hit) const;

    schema::TexturedNumber normal_, tangent_;
    bool baseTurned_; // the axes of the hit are those of the base, which has a tangent of its own
};

} // namespace abbe

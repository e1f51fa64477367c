// The placement of an object in render space: rays inwards, hits outwards.
#pragma once

#include "math/bounds.h"
#include "math/transform.h"
#include "render/ray.h"
#include "render/surface_hit.h"

#include <array>

namespace abbe {

// The map is rounded to float once, so that Embree traces exactly the map by which hits are carried back.
class Instance {
  public:
    // Requires an invertible map.
    explicit Instance(const Transform& objectToRender);

    const Transform& map() const { return objectToRender_; } // as rounded
    std::array<float, 12> rowMajor() const;
    // The direction keeps its length in object units, so distances along the ray stay those of render space.
    Ray toObject(const Ray&) const;
    // From object to render space: point, error bound, normals, frame. Outward normals stay outward.
    void toRender(SurfaceHit&) const;
    Bounds3 toRender(const Bounds3&) const;

  private:
    Transform objectToRender_, renderToObject_;
    double absolute_[3][3];  // |A|
    double roundTrip_[3][3]; // |A| |A⁻¹|: how much the rounding of a ray in object space weighs in render space
};

} // namespace abbe

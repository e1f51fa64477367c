// What a path is in: the dielectrics that it has entered and the media that scatter there.
#pragma once

#include "integrators/dielectric_stack.h"
#include "integrators/medium_stack.h"
#include "render/surface_hit.h"

#include <span>

namespace abbe {

// Rays that leave a hit shall start before or behind other faces that coincide with it.
inline void leaveBeyond(SurfaceHit& hit, std::span<const SurfaceHit> others) {
    for (const SurfaceHit& other : others) hit.pError = hit.pError + abs(other.p - hit.p) + other.pError;
}

// A dielectric's own medium is there only where that dielectric fills the space; the interiors of other shapes add up.
class Surroundings {
  public:
    const MediumStack& media() const { return media_; }

    // Steps over the surface at `hit` in the direction `w`. False if something did not fit.
    bool cross(const SurfaceHit& hit, Vec3 w) {
        const Material& material = *hit.material;
        const bool entering = dot(w, hit.ng) < 0;
        if (!material.ior()) return step(material.interior(), entering);
        const Material* const before = dielectrics_.top();
        bool fits = true;
        if (entering)
            fits = dielectrics_.enter(&material);
        else
            dielectrics_.leave(&material);
        const Material* const after = dielectrics_.top();
        if (before == after) return fits;
        if (before) step(before->interior(), false);
        return (!after || step(after->interior(), true)) && fits;
    }

    bool contains(const Material* dielectric) const { return dielectrics_.contains(dielectric); }
    // What fills the space here; null: air.
    const Material* filling() const { return dielectrics_.top(); }
    // Refractive index here; null: air, 1.
    const Curve* ior() const {
        const Material* const material = filling();
        return material ? material->ior() : nullptr;
    }
    // Absorption coefficient here, 1/m; null: clear.
    const Curve* absorption() const {
        const Material* const material = filling();
        return material ? material->absorption() : nullptr;
    }

  private:
    bool step(const Medium* medium, bool entering) {
        if (!medium) return true;
        if (entering) return media_.enter(medium);
        media_.leave(medium);
        return true;
    }

    MediumStack media_;
    DielectricStack dielectrics_;
};

} // namespace abbe

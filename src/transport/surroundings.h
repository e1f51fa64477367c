// What a path is in: the dielectrics that it has entered [Schmidt2002] and the media that scatter there.
#pragma once

#include "render/material.h"
#include "render/medium.h"
#include "render/scene.h"
#include "render/surface_hit.h"

#include <array>
#include <cstddef>
#include <span>

namespace abbe {

// What a path has entered and not left: things that others own, in the order of entry. A path that enters more than
// kMax at once is in an image of soup; what does not fit is counted by the caller and not followed.
template <typename T> class EnteredStack {
  public:
    static constexpr int kMax = 16;

    // Paths copy them at every surface, and have mostly entered next to nothing: only that is copied.
    EnteredStack() {} // NOLINT: what lies beyond the size is never read
    EnteredStack(const EnteredStack& other) { *this = other; }
    EnteredStack& operator=(const EnteredStack& other) {
        size_ = other.size_;
        for (std::size_t i = 0; i < static_cast<std::size_t>(size_); ++i) entered_[i] = other.entered_[i];
        return *this;
    }

    int size() const { return size_; }
    const T* operator[](int i) const { return entered_[static_cast<std::size_t>(i)]; }
    bool contains(const T* thing) const { return lastOf(thing) >= 0; }
    // False if it is full.
    bool enter(const T* thing) {
        if (size_ == kMax) return false;
        entered_[static_cast<std::size_t>(size_++)] = thing;
        return true;
    }
    // Leaving what was never entered does nothing: a mesh with a hole in it is no reason to go astray.
    void leave(const T* thing) {
        int i = lastOf(thing);
        if (i < 0) return;
        for (--size_; i < size_; ++i) entered_[static_cast<std::size_t>(i)] = (*this)[i + 1];
    }

  private:
    int lastOf(const T* thing) const {
        int i = size_ - 1;
        while (i >= 0 && (*this)[i] != thing) --i;
        return i;
    }

    std::array<const T*, kMax> entered_;
    int size_ = 0;
};

// The media of the shapes whose interiors a path is in; interiors that overlap add up.
using MediumStack = EnteredStack<Medium>;

// Which dielectrics a path has entered [Schmidt2002].
class DielectricStack : public EnteredStack<Material> {
  public:
    // What fills the space here; null: air. Where dielectrics overlap, it is the one of the highest priority; among
    // equals the one entered last.
    const Material* top() const {
        const Material* best = nullptr;
        for (int i = 0; i < size(); ++i)
            if (!best || (*this)[i]->priority() >= best->priority()) best = (*this)[i];
        return best;
    }
};

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

// What a camera is immersed in: what the shapes that contain a point at a time (in the shutter interval) are made of
// and filled with: those that a ray from it leaves without having entered them.
Surroundings surroundingsAt(const Scene&, Vec3 point, float time);

// Faces of dielectrics that separate nothing, because they lie within others [Schmidt2002]. Whether the surface of a
// dielectric, hit along the ray from `here`, separates nothing: the same dielectric fills the space on both sides.
// `beyond` becomes what lies behind it, and hit.outside is set. Faces of several shapes that coincide are hit as one:
// `hit` becomes the face of the dielectric that is entered or, if none is, left.
inline bool isHiddenFace(const Scene& scene, SurfaceHit& hit, const Ray& ray, const Surroundings& here,
                         Surroundings& beyond) {
    const Material* const before = here.filling();
    const bool known = dot(ray.direction, hit.ng) < 0 || here.contains(hit.material);
    beyond = here;
    beyond.cross(hit, ray.direction);
    std::array<SurfaceHit, 4> others;
    std::size_t count = 0;
    if (scene.nested) {
        count = scene.intersector->coincident(ray, hit, others);
        for (std::size_t i = 0; i < count; ++i) beyond.cross(others[i], ray.direction);
        leaveBeyond(hit, std::span(others).first(count));
    }
    const Material* const after = beyond.filling();
    // A dielectric that is left without having been entered, as through a hole, is taken to have been there.
    if (before == after && !known && (!before || hit.material->priority() >= before->priority())) {
        hit.outside = here.ior();
        return false;
    }
    if (before == after) return true;
    const auto takeFaceOf = [&, offset = hit.pError](const Material* material) {
        for (std::size_t i = 0; i < count && hit.material != material; ++i)
            if (others[i].material == material) hit = others[i];
        hit.pError = offset;
        return hit.material == material;
    };
    if (!after || !takeFaceOf(after)) takeFaceOf(before);
    hit.outside = hit.material == after ? here.ior() : beyond.ior();
    return false;
}

} // namespace abbe

// A material with holes, normal and bump maps, or a priority among nested dielectrics.
#pragma once

#include "materials/normal_map.h"
#include "render/surface_input.h"
#include "scene/forwarding_material.h"

namespace abbe {

// A texture of heights: what bends the shading normal besides a NormalMap.
struct BumpMap {
    const Texture* texture = nullptr; // its first channel
    float height = 0;                 // m where it is 1
};

// Refers to the inner material and to the textures. The bump is laid over the normal map.
class DressedMaterial final : public ForwardingMaterial {
  public:
    struct Dress {
        NumberInput opacity;
        NormalMap normal;
        BumpMap bump;
        int priority = 0;
    };
    DressedMaterial(const Material& inner, const Dress& dress) : ForwardingMaterial(inner), dress_(dress) {}

    Effects needs() const override;
    bool usesTextures() const override;
    bool bends() const override { return dress_.normal.texture || dress_.bump.texture || inner_.bends(); }
    // The normal that the maps say, as far as consistentNormal() lets it.
    void bend(SurfaceHit&) const noexcept override;
    bool isOpaque() const override { return inner_.isOpaque() && !mayBeOpen(); }
    bool mayBeOpen() const override { return !dress_.opacity.is(1) || inner_.mayBeOpen(); }
    float opacity(const SurfaceHit& hit) const noexcept override {
        return dress_.opacity.at(hit) * inner_.opacity(hit);
    }
    int priority() const override { return dress_.priority; }

  private:
    Dress dress_;
};

// The unit normal that the map says, in ng's hemisphere or not: `hit` unbent. Where there are no texture coordinates
// (dpdu = 0) only what the map says of positions counts.
Vec3 bumpedNormal(const BumpMap&, const SurfaceHit& hit);

} // namespace abbe

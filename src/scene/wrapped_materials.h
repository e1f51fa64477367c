// Materials that are another one but for what they change: with holes and bent normals, filled with a medium, or clear.
#pragma once

#include "materials/bent_normal.h"
#include "render/material.h"
#include "render/medium.h"
#include "render/surface_input.h"

namespace abbe {

// All as the inner material has it, to which it refers.
class ForwardingMaterial : public Material {
  public:
    explicit ForwardingMaterial(const Material& inner) : inner_(inner) {
        traits_ = inner.traits();
        inside_ = inner.inside();
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return inner_.bsdf(hit, lambda, arena);
    }
    void bend(SurfaceHit& hit) const noexcept override { inner_.bend(hit); }
    float opacity(const SurfaceHit& hit) const noexcept override { return inner_.opacity(hit); }
    SurfaceEmission emission() const override { return inner_.emission(); }

  protected:
    const Material& inner_;
};

// A texture of heights: what bends the shading normal besides a NormalMap.
struct BumpMap {
    const Texture* texture = nullptr; // its first channel
    float height = 0;                 // m where it is 1
};

// A material with holes, normal and bump maps, or a priority among nested dielectrics. Refers to the textures, too. The
// bump is laid over the normal map.
class ModifiedMaterial final : public ForwardingMaterial {
  public:
    struct Modifiers {
        NumberInput opacity;
        NormalMap normal;
        BumpMap bump;
        int priority = 0;
    };
    ModifiedMaterial(const Material& inner, const Modifiers&);

    // The normal that the maps say, as far as consistentNormal() lets it.
    void bend(SurfaceHit&) const noexcept override;
    float opacity(const SurfaceHit& hit) const noexcept override {
        return modifiers_.opacity.at(hit) * inner_.opacity(hit);
    }

  private:
    Modifiers modifiers_;
};

// The unit normal that the map says, in ng's hemisphere or not: `hit` unbent. Where there are no texture coordinates
// (dpdu = 0) only what the map says of positions counts.
Vec3 bumpedNormal(const BumpMap&, const SurfaceHit& hit);

// A material whose shapes are filled with a medium, to which it refers.
class FilledMaterial final : public ForwardingMaterial {
  public:
    FilledMaterial(const Material& surface, const Medium& interior) : ForwardingMaterial(surface) {
        traits_.needs |= interior.needs();
        inside_.interior = &interior;
    }
};

// A dielectric that absorbs nothing.
class ClearMaterial final : public ForwardingMaterial {
  public:
    explicit ClearMaterial(const Material& inner) : ForwardingMaterial(inner) {
        const auto absorbs = static_cast<Effects::Bits>(Effect::absorption);
        traits_.needs = Effects::fromBits(static_cast<Effects::Bits>(inner.needs().bits() & ~absorbs));
        inside_.absorption = nullptr;
    }
};

} // namespace abbe

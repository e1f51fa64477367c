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
    explicit ForwardingMaterial(const Material& inner) : inner_(inner) {}

    Effects needs() const override { return inner_.needs(); }
    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        return inner_.bsdf(hit, lambda, arena);
    }
    bool choosesLobe() const override { return inner_.choosesLobe(); }
    const Curve* absorption() const override { return inner_.absorption(); }
    const Medium* interior() const override { return inner_.interior(); }
    bool isBoundary() const override { return inner_.isBoundary(); }
    bool isOpaque() const override { return inner_.isOpaque(); }
    bool reversible() const override { return inner_.reversible(); }
    bool focuses() const override { return inner_.focuses(); }
    bool usesTextures() const override { return inner_.usesTextures(); }
    bool bends() const override { return inner_.bends(); }
    void bend(SurfaceHit& hit) const noexcept override { inner_.bend(hit); }
    bool mayBeOpen() const override { return inner_.mayBeOpen(); }
    float opacity(const SurfaceHit& hit) const noexcept override { return inner_.opacity(hit); }
    const Curve* ior() const override { return inner_.ior(); }
    int priority() const override { return inner_.priority(); }
    bool seesOutside() const override { return inner_.seesOutside(); }
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
    ModifiedMaterial(const Material& inner, const Modifiers& modifiers)
        : ForwardingMaterial(inner), modifiers_(modifiers) {}

    Effects needs() const override;
    bool usesTextures() const override;
    bool bends() const override { return modifiers_.normal.texture || modifiers_.bump.texture || inner_.bends(); }
    // The normal that the maps say, as far as consistentNormal() lets it.
    void bend(SurfaceHit&) const noexcept override;
    bool isOpaque() const override { return inner_.isOpaque() && !mayBeOpen(); }
    bool mayBeOpen() const override { return !modifiers_.opacity.is(1) || inner_.mayBeOpen(); }
    float opacity(const SurfaceHit& hit) const noexcept override {
        return modifiers_.opacity.at(hit) * inner_.opacity(hit);
    }
    int priority() const override { return modifiers_.priority; }

  private:
    Modifiers modifiers_;
};

// The unit normal that the map says, in ng's hemisphere or not: `hit` unbent. Where there are no texture coordinates
// (dpdu = 0) only what the map says of positions counts.
Vec3 bumpedNormal(const BumpMap&, const SurfaceHit& hit);

// A material whose shapes are filled with a medium, to which it refers.
class FilledMaterial final : public ForwardingMaterial {
  public:
    FilledMaterial(const Material& surface, const Medium& interior)
        : ForwardingMaterial(surface), interior_(interior) {}

    Effects needs() const override { return inner_.needs() | interior_.needs(); }
    const Medium* interior() const override { return &interior_; }

  private:
    const Medium& interior_;
};

// A dielectric that absorbs nothing.
class ClearMaterial final : public ForwardingMaterial {
  public:
    using ForwardingMaterial::ForwardingMaterial;

    Effects needs() const override {
        const auto absorbs = static_cast<Effects::Bits>(Effect::absorption);
        return Effects::fromBits(static_cast<Effects::Bits>(inner_.needs().bits() & ~absorbs));
    }
    const Curve* absorption() const override { return nullptr; }
};

} // namespace abbe

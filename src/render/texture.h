// Values over a surface: images and procedural patterns.
#pragma once

#include "base/source.h"
#include "math/vec.h"
#include "spectrum/color_space.h"
#include "spectrum/curve.h"

#include <algorithm>
#include <array>

namespace abbe {

class Diagnostics;
struct SurfaceHit;

// What a texture is asked for.
enum class TextureUse : std::uint8_t {
    heights,     // jet(): displacement, bumps
    number,      // value() of plain numbers: a roughness, an opacity, the directions of a normal map
    reflectance, // spectrum(): 0 … 1 at every wavelength
    light,       // lightFactor(): without an upper bound
};

// Where a surface asks for a value, and over how large an area it wants the mean of it.
struct TextureQuery {
    explicit TextureQuery(const SurfaceHit&); // render/surface_input.h
    TextureQuery(Vec2 place, Vec3 point) : uv(place), position(point) {}

    Vec2 uv;
    Vec2 du, dv;                     // half axes of the footprint in uv, the longer one first; 0: a point
    Vec3 position;                   // in the shape's own space, m
    Vec3 normal;                     // unit, in the shape's own space
    float radius = 0;                // of the footprint, in the shape's own space, m
    const SurfaceHit* hit = nullptr; // for the attributes of its shape; may be null
};

struct TexturePoint {
    Vec3d position; // in the shape's own space, m
    Vec2 uv;
    Vec2 home; // uv of the middle of the face: says which of two image tiles is meant on their border
};

// A value of up to three channels, and how it changes with each coordinate. Channels that were not asked for are 0.
struct TextureJet {
    Vec3 value;
    std::array<Vec3, 3> byPosition; // ∂value/∂x, ∂y, ∂z
    std::array<Vec3, 2> byUv;       // ∂value/∂u, ∂v
};

// Thread-safe and without visible changes once prepare() has run for every use.
class Texture {
  public:
    virtual ~Texture() = default;
    virtual int channels() const = 0; // 1 or 3
    virtual bool needsUv() const = 0;
    // The primaries of value() if its channels are a colour; null if they are plain numbers, or either (a pattern).
    virtual const RgbSpace* rgbSpace() const { return nullptr; }
    // Called by whoever binds the texture to a field, before the first lookup of that use, on one thread and perhaps
    // several times: gets ready for it, and reports at `user` what speaks against it. False after an error.
    virtual bool prepare(TextureUse, Span /*user*/, Diagnostics&) { return true; }
    // Values and first derivatives are continuous wherever the texture is. Requires 1 ≤ channels ≤ channels().
    virtual TextureJet jet(const TexturePoint&, int channels) const noexcept = 0;
    // The mean over the footprint, for shading; requires prepare(). Channels beyond channels() repeat the first one.
    // Linear RGB for colours, the stored numbers for data.
    virtual Vec3 value(const TextureQuery& query) const noexcept {
        const TextureJet j = jet({Vec3d(query.position), query.uv, query.uv}, channels());
        return channels() == 1 ? Vec3(j.value.x, j.value.x, j.value.x) : j.value;
    }
    // Its first channel: patterns of three independent channels need not make the others.
    virtual float number(const TextureQuery& query) const noexcept { return value(query).x; }
    // The same as a reflectance, 0 … 1 at every wavelength. By default the first channel, flat.
    virtual Spectrum spectrum(const TextureQuery& query, const Wavelengths&) const noexcept {
        return Spectrum(std::clamp(number(query), 0.f, 1.f));
    }
    // The same as a factor of light, >= 0 and without an upper bound: white, 1, leaves it as it is. By default the
    // first channel, flat.
    virtual Spectrum lightFactor(const TextureQuery& query, const Wavelengths&) const noexcept {
        return Spectrum(std::max(number(query), 0.f));
    }
    // What went wrong in lookups since it was made, as warnings; called after rendering.
    virtual void reportLookups(Diagnostics&) const {}
    // False if uv lies where the texture has nothing to show: in a tile without a file.
    virtual bool covers(Vec2 uv) const noexcept {
        static_cast<void>(uv);
        return true;
    }
};

} // namespace abbe

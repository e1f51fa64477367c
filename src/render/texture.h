// Values over a surface: images and procedural patterns.
#pragma once

#include "math/vec.h"

#include <array>

namespace abbe {

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

// Immutable after construction, thread-safe.
class Texture {
  public:
    virtual ~Texture() = default;
    virtual int channels() const = 0; // 1 or 3
    virtual bool needsUv() const = 0;
    // Values and first derivatives are continuous wherever the texture is. Requires 1 ≤ channels ≤ channels().
    virtual TextureJet jet(const TexturePoint&, int channels) const noexcept = 0;
    // False if uv lies where the texture has nothing to show: in a tile without a file.
    virtual bool covers(Vec2 uv) const noexcept {
        static_cast<void>(uv);
        return true;
    }
};

} // namespace abbe

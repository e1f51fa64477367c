// How a texture moves a subdivision surface.
#pragma once

#include "math/vec.h"
#include "render/texture.h"

#include <cstdint>
#include <optional>

namespace abbe {

// The offset of a point is amount · (value − midpoint) in every channel of the texture. All in the space of the cage.
struct Displacement {
    enum class Space : std::uint8_t {
        normal,  // one channel, along the normal of the limit surface
        tangent, // three: along the texture's u (made perpendicular to the normal), the other tangent, and the normal
        object,  // three: along x, y and z
    };
    Space space = Space::normal;
    double amount = 0; // m
    double midpoint = 0;
    const Texture* map = nullptr; // not owned; outlives its use

    int channels() const { return space == Space::normal ? 1 : 3; }
};

// A point of a parametrised surface with its first and second derivatives; positions about a centre near it.
struct SurfaceJet {
    Vec3d p, u, v, uu, uv, vv;
    Vec2d t, tu, tv, tuu, tuv, tvv; // texture coordinates
};

// Where a displaced point goes: position + direction · length.
struct DisplacedPoint {
    Vec3d direction;
    double length = 0;
    Vec3d normal; // of the displaced surface, on the side of du × dv; unit length, or 0 if nothing tells it
};

// Moves a point; the normal is that of the moved surface, with the change of the normal along it (its curvature) and,
// for tangents, the change of their frame. The tangent frame is T along ∂P/∂u of the texture coordinates and B = ±N × T
// on the side of ∂P/∂v, so that (T, B, N) is right-handed unless the texture is mirrored; without usable texture
// coordinates T lies along du. Nothing if the surface has no normal there. `center` is added to positions before the
// texture sees them.
std::optional<DisplacedPoint> displace(const SurfaceJet&, const Displacement&, Vec3d center, Vec2 home,
                                       double smallTangent);

} // namespace abbe

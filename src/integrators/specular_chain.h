// A path from a point over delta interfaces towards a light.
#pragma once

#include "integrators/chain_signature.h"
#include "render/surface_hit.h"
#include "spectrum/spectrum.h"

#include <array>

namespace abbe {

struct ChainVertex {
    SurfaceHit hit; // with arrival and outside
    Vec3d p;
    Vec3d in, out;           // unit, in the direction of the camera path
    Spectrum clearness{1.f}; // of the way from the vertex before: absorption and openings
};

// As a camera path runs: from the receiver to the light. Render space, in double.
struct SpecularChain {
    std::array<ChainVertex, ChainSignature::kMaxLength> vertices;
    int length = 0;
    Vec3d direction;            // unit, at the receiver
    Vec2d miss;                 // of the last direction past the target; 0 for a solution
    double jacobian[2][2] = {}; // of the miss by the direction, across two axes (tangentsOf); exact where the miss is 0
    double spread2 = 1; // m², what turns solid angle at the last vertex into area at the target; 1 for far targets
    Spectrum clearness{1.f}; // of the way from the last vertex to the light

    const ChainVertex& last() const { return vertices[static_cast<std::size_t>(length - 1)]; }
    double determinant() const { return jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0]; }
    double miss2() const { return miss.x * miss.x + miss.y * miss.y; }
};

} // namespace abbe

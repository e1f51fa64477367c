// A polygon of a mesh seen large from a receiver, and directions into it.
#pragma once

#include "geometry/spherical_triangle.h"
#include "math/warp.h"
#include "render/receiver.h"

#include <array>
#include <optional>
#include <span>

namespace abbe {

// A triangle or the two halves of a quad. Directions are uniform per solid angle [Arvo1995], or, for receivers lit from
// one side, about in proportion to the cosine there [Hart2020].
class NearPolygon {
  public:
    using Corners = std::array<Vec3, 3>;
    struct Sample {
        int half;     // which triangle
        Vec2 weights; // of its second and third corner
        float pdf;    // per solid angle
    };

    // Nothing where sampling per area serves as well or better: from afar, for solid angles below 3e-4 sr
    // (docs/hard_cases.md, case 31), in the plane or at a corner of the polygon, for quads that are bent.
    // The halves of a quad share their second and third corners.
    static std::optional<NearPolygon> seen(std::span<const Corners> triangles, const Receiver&);

    // Nothing if all of it is below the receiver's horizon. u in [0, 1)².
    std::optional<Sample> sample(Vec2 u) const;
    // Density with which sample() makes a point of the polygon.
    float pdf(Vec3 p) const;

  private:
    struct Half {
        Vec3d a, s, t; // the first corner, relative to the receiver, and the edges from it
        std::optional<SphericalTriangle> view;
        BilinearDensity cosine{{1, 1, 1, 1}};
        double mean = 1;   // cosine
        double weight = 0; // solid angle × mean
    };
    void weigh(const Receiver&);
    const Half& halfOf(Vec3d p) const;
    static Vec2 weightsAlong(const Half&, Vec3d direction);

    std::array<Half, 2> halves_;
    int count_ = 0;
    double weight_ = 0;
    Vec3d from_;
    bool byCosine_ = false;
};

} // namespace abbe

// What is seen large from a point, and directions into it: a rectangle [Urena2013], a triangle [Arvo1995], a polygon of
// a mesh, and a sphere by the cosine at a receiver.
#pragma once

#include "math/vec.h"
#include "math/warp.h"
#include "render/receiver.h"

#include <array>
#include <optional>
#include <span>

namespace abbe {

// In the rectangle's own coordinates relative to the point: x and y along its sides, z along its normal.
// The paper takes the angles of the spherical polygon by acos, which loses half its digits near 0 and π (points near
// the plane). Here the sine is known without cancellation and the angle comes from atan2.
class SphericalRectangle {
  public:
    // The rectangle [x0, x1] × [y0, y1] at height z; any sign of z. A point in the plane gives solid angle 0.
    SphericalRectangle(float x0, float y0, float x1, float y1, float z);

    float solidAngle() const { return solidAngle_; }
    // (x, y) on the rectangle, uniform per solid angle. Requires solidAngle() > 0.
    Vec2 sample(Vec2 u) const;
    // The u that samples a point of the rectangle, to about 1e-6 sr over the solid angle.
    Vec2 inverse(Vec2 point) const;

  private:
    float x0_, y0_, x1_, y1_, z_;
    float b0_, b1_;    // z components of the normals of the planes through the sides y = y0 and y = y1
    float sine0_;      // sqrt(1 - b0²)
    float k_;          // 2π - γ2 - γ3 of the paper
    float solidAngle_; // sr
};

class SphericalTriangle {
  public:
    // Corners relative to the point, none of which is 0.
    SphericalTriangle(Vec3d a, Vec3d b, Vec3d c);

    double solidAngle() const { return solidAngle_; } // sr, of either side
    // A unit vector. The corners of the square are b (twice), a and c: (0, 0), (1, 0), (0, 1) and (1, 1).
    // Requires solidAngle() > 0.
    Vec3d direction(Vec2 u) const;
    // The u of a direction into the triangle.
    Vec2 inverse(Vec3d direction) const;

  private:
    Vec3d a_, b_, c_; // unit
    double solidAngle_;
};

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

// Uniform over the projection of the cone to the sphere on the receiver's tangent plane: an ellipse, or where the
// horizon cuts the cone, what of it lies within the unit circle's arc [Peters2019].
class ProjectedCap {
  public:
    // Of the cone towards a sphere at distance² d2 > r2 in the unit direction `axis`. Nothing if it is too narrow for
    // the cosine to vary, hardly above the horizon, or if light from behind the receiver counts, too. A sampler and its
    // density both decide by this function.
    static std::optional<ProjectedCap> seen(const Receiver& from, Vec3d axis, double d2, double r2);

    Vec3d direction(Vec2 u) const; // unit, in the cone but for rounding
    double pdf(Vec3d w) const;     // 1/sr, of a direction in the cone

  private:
    ProjectedCap() = default;
    double middle(double y) const;
    double wing(double y) const;
    double inverse(double area) const;
    Vec2d place(Vec2 u) const;

    Vec3d n_, x_, y_;       // of the receiver; the axis of the cone is in the plane of n and x
    double centre_ = 0;     // of the ellipse, along x
    double a_ = 0, b_ = 0;  // its half axes, along x and y; a < 0 where the sphere's centre is below the horizon
    double tangent_ = 0;    // y where the ellipse meets the unit circle; 0 where the horizon does not cut the cone
    double middleArea_ = 0; // of the half y > 0: between the ellipse and the arc, up to the tangent
    double solidAngle_ = 0; // projected, sr
};

} // namespace abbe

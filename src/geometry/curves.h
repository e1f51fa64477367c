// Hair, fur, wires, grass: thin curves with a width; one segment of them as a polynomial, in double, and where exactly
// a ray hits it.
#pragma once

#include "render/shape.h"

#include <array>
#include <vector>

namespace abbe {

// Position and radius over u in [0, 1]: Σ c[k] u^k.
class CurveSegment {
  public:
    // `points`: the segment's first control point; two are read for linear, else four.
    CurveSegment(CurveBasis, const SizedPoint* points);

    Vec3d position(double u) const { return c_[0] + u * (c_[1] + u * (c_[2] + u * c_[3])); }
    Vec3d derivative(double u) const { return c_[1] + u * (2.0 * c_[2] + (3 * u) * c_[3]); }
    Vec3d secondDerivative(double u) const { return 2.0 * c_[2] + (6 * u) * c_[3]; }
    // Not negative, though a spline through positive radii may be.
    double radius(double u) const { return std::max(0.0, r_[0] + u * (r_[1] + u * (r_[2] + u * r_[3]))); }
    double radiusDerivative(double u) const { return r_[1] + u * (2 * r_[2] + 3 * u * r_[3]); }

    // Unit direction of travel. Where the derivative vanishes (cusps, equal control points) it comes from differences
    // over a growing interval (docs/hard_cases.md, case 22); nothing if the whole segment is one point.
    std::optional<Vec3d> tangent(double u) const;
    // The control points of the same segment as a Bézier curve: it lies in their hull, its radius between theirs.
    void bezier(std::array<Vec3d, 4>& points, std::array<double, 4>& radii) const;

  private:
    std::array<Vec3d, 4> c_;
    std::array<double, 4> r_;
};

struct CurvePoint {
    Vec3d p;       // on the surface
    Vec3d normal;  // unit: out of a tube, to the ray from a ribbon
    Vec3d tangent; // unit
    double u;
    double across; // −1 … 1, as the ray sees it
};

// `u` and `t` as Embree found them, with float precision and, far from the ray's origin, less. `d` is of unit length.
// All results are finite, for degenerate segments too.
CurvePoint tubePoint(const CurveSegment&, double u, Vec3d o, Vec3d d, double t);
// Of two spheres and the cone that touches both.
CurvePoint conePoint(const SizedPoint& a, const SizedPoint& b, Vec3d o, Vec3d d, double t);
// Distances at which a ray enters and leaves that body, which may lie behind it.
std::optional<Vec2d> intersectCone(const SizedPoint& a, const SizedPoint& b, Vec3d o, Vec3d d);
CurvePoint ribbonPoint(const CurveSegment&, double u, Vec3d o, Vec3d d);

// Strands one after the other: strand i has the next `strandSizes[i]` control points.
struct CurveData {
    CurveBasis basis = CurveBasis::bspline;
    CurveForm form = CurveForm::round;
    std::vector<SizedPoint> points;
    std::vector<std::uint32_t> strandSizes;
    // The same points at further time steps (see TimeSteps), after `points` at the first; none: all stands still.
    std::vector<std::vector<SizedPoint>> later = {};
};

// Control points that a strand needs at the least, and how many each further segment takes.
constexpr std::uint32_t leastPoints(CurveBasis b) { return b == CurveBasis::linear ? 2 : 4; }
constexpr std::uint32_t pointStep(CurveBasis b) { return b == CurveBasis::bezier ? 3 : 1; }

// Segments without width or length at all times are left out: nobody can see them.
// Hits: u runs from 0 to 1 along the whole strand, v across it as the ray sees it (0.5 in the middle). The primitive is
// the strand. The shading frame's x is the direction of travel; ng points out of tubes and to the ray from ribbons.
// Under maps that stretch unevenly tubes become elliptical and ribbons turn to the ray of their own space.
class Curves final : public Shape {
  public:
    // Requires finite positions, finite radii >= 0, sizes that sum to the number of points and that each are
    // leastPoints + a multiple of pointStep; and as many points at every time step, at most kMaxTimeSteps of them.
    explicit Curves(CurveData);

    std::size_t segmentCount() const { return firstPoints_.size(); }
    std::size_t omittedSegments() const { return omitted_; }
    std::size_t bytes() const; // of the data that rays refer to, without the acceleration structure

    Bounds3 bounds() const override { return bounds_; } // at all times
    void commit(GeometrySink&) const override;
    bool confirms(const RawHit&, const Ray&) const override;
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    // dp/dv is taken as twice the radius across the curve: exact for ribbons and in the middle of tubes.
    void parametrize(const RawHit&, const Ray&, SurfaceHit&) const override;
    Vec3 carried(const RawHit&, const Ray&, const SurfaceHit&, float time) const override;
    double area() const override { return area_; } // of tubes without ends; of ribbons seen from the side; at first

  private:
    void addStrand(std::uint32_t strand, std::uint32_t first, std::uint32_t size);
    void addBounds(const std::vector<SizedPoint>& step, std::uint32_t first);
    bool isVisible(std::uint32_t first) const;
    double sumOfAreas() const;
    // Points in a row at a time: those kept, or moved ones, made in `room`, which holds four.
    const SizedPoint* pointsAt(std::uint32_t first, std::uint32_t count, float time, SizedPoint* room) const;

    CurveData data_;
    std::vector<std::uint32_t> firstPoints_; // of each segment
    std::vector<std::uint32_t> strand_;      // of each segment
    std::vector<std::uint32_t> strandFirst_; // first point of each strand, and the end
    std::vector<std::uint8_t> neighbours_;   // CurveNeighbour, for round linear curves
    std::size_t omitted_ = 0;
    Bounds3 bounds_;
    double area_ = 0; // asked for several times while a scene is built
};

} // namespace abbe

// How one face is cut by the rates of its edges, which vertices a diced surface then has, and which faces share them.
// Included by the subdivision sources only.
#pragma once

#include "geometry/subdivision_limit.h"
#include "math/vec.h"

#include <array>
#include <opensubdiv/bfr/parameterization.h>
#include <vector>

namespace abbe {

// Points: first those of the boundary, once around from corner 0 along edge 0, then those inside.
struct FacePattern {
    std::vector<Vec2> points; // in the parametrisation of the face
    std::vector<std::array<int, 3>> triangles;
    std::vector<std::array<int, 4>> quads;
    std::size_t boundary = 0;

    std::size_t inside() const { return points.size() - boundary; }
};

// Makes patterns and keeps the last one: neighbours often ask for the same.
class PatternMaker {
  public:
    // Valid until the next call. `rates` has one entry per edge.
    const FacePattern& pattern(const OpenSubdiv::Bfr::Parameterization&, const std::vector<int>& rates);

  private:
    void grid(int across, int along);
    void general(const OpenSubdiv::Bfr::Parameterization&, const std::vector<int>& rates);

    FacePattern pattern_;
    std::vector<int> rates_;
    std::vector<int> facets_;
};

// Vertices are numbered: cage vertices, then points inside edges, then points inside faces. A vertex is shared by the
// faces around it as long as the surface is smooth and the texture coordinates are continuous from one to the next.
// Sides are edges as faces see them, numbered like corners.
struct SubdivisionLayout {
    SubdivisionLayout(const SubdivisionSurface::Impl&, const std::vector<int>& edgeRates);

    std::vector<std::uint32_t> cornerVertex; // of every corner of a face with a surface
    std::vector<std::uint32_t> sideFirst;    // first point inside the edge, in the direction of the edge
    // The face that evaluates a shared vertex or side is the one whose corner or side leads.
    std::vector<std::uint8_t> cornerLeads, sideLeads;
    std::vector<std::uint8_t> sideReversed; // the face runs against the direction of the edge
    std::vector<DicedSeam> seams;
    std::vector<DicedSeam> smoothSeams; // of vertices that only texture coordinates tell apart; pairs of their own
    std::uint32_t vertexCount = 0;      // without those inside faces

  private:
    void joinCorners(const SubdivisionSurface::Impl&, bool acrossTexture);
    void pairSmoothCorners(const SubdivisionSurface::Impl&);
    void numberCorners(const SubdivisionSurface::Impl&);
    void numberSides(const SubdivisionSurface::Impl&, const std::vector<int>& edgeRates);
    std::uint32_t root(std::uint32_t corner);

    std::vector<std::uint32_t> joined_; // union-find over corners
};

} // namespace abbe

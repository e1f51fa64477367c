// Which vertices a diced surface has, and which faces share them. Included by the subdivision sources only.
#pragma once

#include "geometry/subdivision_limit.h"

#include <vector>

namespace abbe {

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

// How one face is cut by the rates of its edges. Included by the subdivision sources only.
#pragma once

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

} // namespace abbe

// A closed quad cage whose Catmull-Clark surface follows a form.
#pragma once

#include "form.h"

#include <map>
#include <vector>

namespace dragon {

using Quad = std::array<int, 4>;
using Edge = std::array<int, 2>; // the smaller number first
inline Edge edge(int a, int b) { return a < b ? Edge{a, b} : Edge{b, a}; }

struct Cage {
    std::vector<Vec> points;
    std::vector<Quad> faces;              // counter-clockwise seen from outside
    std::vector<Part> parts;              // per face
    std::vector<std::array<Vec2, 4>> uvs; // per face, empty before charts are made
    std::map<Edge, int> creases;          // sharpness
};

// The faces beside every edge: the one that runs along it from the smaller number first. Throws unless the cage is
// closed and manifold.
std::map<Edge, std::array<int, 2>> edgeFaces(const Cage& cage);

Cage makeCage();

// One step of Catmull-Clark subdivision; face f becomes 4f … 4f+3, one for each corner. Texture coordinates are linear.
Cage subdivide(const Cage& cage);

} // namespace dragon

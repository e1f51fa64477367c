// Subdivision surfaces: the smooth limit of a cage, diced into a mesh without cracks; and what must hold of a cage
// before it may be subdivided.
#pragma once

#include "geometry/displacement.h"
#include "math/mesh_data.h"
#include "math/transform.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

// The first fault of a cage, naming the face, vertex, crease or corner (from 0); nothing for a sound one. Checked are
// index ranges, sizes of lists, faces of fewer than three or with repeated corners, faces that are no triangles under
// Loop, creases that are no edge of a face, numbers that are not finite or so large that squares overflow, negative
// sharpnesses, creases where two faces lie back to back, and the valence limits of the library underneath (65535).
// Faces in any other arrangement are sound: flipped, doubled, three at an edge.
std::optional<std::string> findFault(const SubdivisionCage&);

// How finely edges are cut. Every face takes the rates of its own edges, so neighbours always agree.
struct Dicing {
    enum class Mode : std::uint8_t { level, length, pixels };
    Mode mode = Mode::level;
    // level: every edge is cut into 2^level pieces (a whole number); length: pieces of at most about so long, in the
    // units of the cage; pixels: pieces of at most about so many pixels.
    double rate = 3;
    // pixels: the size of a pixel at a point, in the units of the cage. Called from many threads.
    std::function<double(Vec3)> pixelSize;
    // Takes the cage to the space where lengths and pixels are measured; nothing: they are measured in its own.
    std::optional<Transform> place = {};
};

// What dicing will make, known before it takes memory.
struct DicingPlan {
    std::vector<int> edgeRates; // pieces of each edge, 1 … 1024
    std::uint64_t triangles = 0;
    std::uint64_t bytes = 0; // estimate for all of it, the acceleration structure included
    double coarser = 1;      // how many times longer than asked for the pieces are, to stay within the budget
};

// Vertices `copy` … `copy + count - 1` have the positions of those from `original` on, bit by bit: normals or texture
// coordinates differ between them, so that creases shade sharply and seams keep their two sides.
struct DicedSeam {
    std::uint32_t copy = 0, original = 0, count = 0;
};

// Whoever moves vertices moves those of a seam alike (once per original) and the surface stays closed.
struct DicedSurface {
    MeshData mesh; // normals always; uvs and attributes if the cage has them; quads, and triangles where rates meet
    std::vector<DicedSeam> seams;
    // Where the faces of the diced mesh that make up a face of the cage begin; with one entry past the last.
    struct Face {
        std::uint64_t firstTriangle = 0, firstQuad = 0;
    };
    std::vector<Face> faces;
};

// Positions lie on the limit surface and normals are perpendicular to its tangents. Where these vanish (poles, sharp
// corners of smooth boundaries) the normal is that of a point a little way inside the same face. Faces without limit
// surface (holes, the rim under Boundary::none) are left out.
class SubdivisionSurface {
  public:
    // Estimated memory of a diced triangle with its share of vertices, normals and acceleration structure
    // (bench/dicing.cpp measures it).
    static constexpr std::uint64_t kBytesPerTriangle = 110;
    static constexpr std::uint64_t kDisplacedBytesPerTriangle = 130; // with what it takes to join seams
    static constexpr int kMaxRate = 1024;
    static constexpr int kMaxLevel = 10;

    // Requires findFault() to find none in the cage.
    explicit SubdivisionSurface(const SubdivisionCage&);
    ~SubdivisionSurface();
    SubdivisionSurface(const SubdivisionSurface&) = delete;
    SubdivisionSurface& operator=(const SubdivisionSurface&) = delete;

    // Chooses the rates; lowers all of them alike until the estimate is at most `maxBytes` or they are 1.
    // Requires rate > 0 (level: 0 … kMaxLevel).
    // With a displacement, edges are measured where it takes them.
    DicingPlan plan(const Dicing&, std::uint64_t maxBytes, const Displacement* = nullptr) const;
    // Runs on threadCount() threads; the result does not depend on how many. Requires a plan of this surface.
    // Displaced normals are those of the displaced surface. Points of seams go to one place: the mean of where their
    // faces take them (along a normal: the mean way along the mean direction). Where the surface is smooth across a
    // seam of texture coordinates, so is the displaced one: its two normals are averaged.
    DicedSurface dice(const DicingPlan&, const Displacement* = nullptr) const;
    // The same for the cage deformed: `points` take the place of its positions, in their order. Faces, texture
    // coordinates, seams and the order of vertices are those of dice(plan) to the bit, whatever the points, so the
    // results are keys of one moving mesh; only positions and normals differ. Choose the plan once, from the cage
    // given to the constructor. Requires as many points as the cage has, finite and below 1e15.
    DicedSurface dice(const DicingPlan&, std::span<const Vec3> points, const Displacement* = nullptr) const;

    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

} // namespace abbe

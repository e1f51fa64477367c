// The checks one by one: solids that are not closed, are inside out, or overlap; sizes, distances and powers that are
// hardly meant, the traces of a unit that was left out or mistaken.
// And the surfaces that bound something, as checks look at them: their faces, whether they are closed, and where lines
// run inside of them.
#pragma once

#include "base/diagnostic.h"
#include "geometry/open_edges.h"
#include "render/intersector.h"
#include "render/material.h"
#include "render/shape.h"
#include "scene/build.h"
#include "schema/scene_tree.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace abbe::checks {

// What a pass over the faces of a shape finds.
struct FaceReport {
    enum class Kind : std::uint8_t { faces, analytic, other };
    Kind kind = Kind::other; // of faces alone; analytic shapes alone. Only of faces anything else here is set
    OpenEdges edges;
    std::vector<std::array<Vec3, 2>> ends; // of the edges that are open or turned
    std::span<const Vec3> vertices;        // as long as the shape
    double volume = 0;                     // m³, signed: negative if the faces of a closed surface look inwards
};
FaceReport readFaces(const Shape&);

// A part of a line, by distances along it.
struct Stretch {
    double from = 0, to = 0;
    double length() const { return to - from; }
};

// A shape that bounds something, in one place.
struct Solid {
    const Shape* shape = nullptr;
    const Material* material = nullptr;
    bool insideObject = false; // its coordinates are those of an object
    FaceReport faces;          // where they were read
    bool sound = true;         // closed by itself, as far as is known, and its outer side is outside
};

// Some solids behind one intersector, to be asked where lines run inside of each.
class SolidTree {
  public:
    // `chosen`: positions in `solids`, which outlive this.
    SolidTree(const std::vector<Solid>& solids, const std::vector<std::size_t>& chosen);
    ~SolidTree();

    // Where the line through a point is inside of solids, by signed distances from it, in order; of a plane the lower
    // half-space is inside. Nothing for a solid that the line enters and leaves in a way that no closed surface has.
    // Requires: they are among the chosen ones.
    using Stretches = std::optional<std::vector<Stretch>>;
    Stretches inside(std::size_t solid, Vec3 through, Vec3 direction) const;
    std::pair<Stretches, Stretches> inside(std::size_t a, std::size_t b, Vec3 through, Vec3 direction) const;
    // Whether a point is inside, by most of a few lines through it.
    bool contains(std::size_t solid, Vec3 p) const;
    // The share of lines through its box that find it open.
    double openShare(std::size_t solid) const;

  private:
    class Marker;
    struct Crossing {
        double at = 0;
        bool enters = false;
    };
    void walk(Vec3 through, Vec3 direction, double reach, std::span<const std::size_t> of,
              std::span<std::vector<Crossing>> crossings) const;
    Stretches stretchesOf(std::size_t solid, const std::vector<Crossing>&) const;

    const std::vector<Solid>& solids_;
    std::vector<std::unique_ptr<const Marker>> markers_; // like solids_; what a hit is known by
    std::unique_ptr<const Intersector> tree_;
};

// Point i of an even sequence in [0, 1)^5: multiples of powers of the root of x⁶ = x + 1 [Roberts2018].
struct EvenPoint {
    double u[5];
    Vec3 within(const Bounds3&) const; // by the first three
};
EvenPoint evenPoint(std::uint32_t i);
Vec3 directionOf(double u, double v); // even over the sphere

// The shapes into which light refracts, with their faces read.
std::vector<Solid> refractingSolids(const BuiltScene&);

// W0605, W0606. Notes which of them are no sound solids.
void checkSurfaces(std::vector<Solid>&, const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0607: closed shapes that emit inwards alone.
void checkEmittingSides(const BuiltScene&, Diagnostics&);

// Lines that all pairs of solids are tried with together, and pairs at most; more are left out.
inline constexpr std::uint32_t kMostOverlapLines = 1u << 20, kMostOverlapPairs = 1u << 14;
// W0608. Requires checkSurfaces(). Solids of one index and colour are one solid, whatever their number.
void checkOverlaps(const std::vector<Solid>&, const BuiltScene&, const schema::SceneTree&, Diagnostics&);

// W0609, for solids; returns whether the camera is inside of something opaque.
bool checkAroundCamera(const std::vector<Solid>&, const BuiltScene&, Diagnostics&);

// W0610: a scene as large as a planet or as small as a bacterium, though no text says so.
void checkExtent(const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0611: a camera from which the scene is a dot.
void checkCameraDistance(const BuiltScene&, const schema::SceneTree&, Diagnostics&);
// W0612: lamps with the power of power stations.
void checkLampPowers(const BuiltScene&, Diagnostics&);
// W0613: a lens for which all of the scene is out of focus.
void checkFocus(const BuiltScene&, const schema::SceneTree&, Diagnostics&);

} // namespace abbe::checks

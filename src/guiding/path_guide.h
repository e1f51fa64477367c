// What is known of the light that arrives at places of a scene: by it paths are guided to where light comes from.
#pragma once

#include "guiding/space_tree.h"

#include <array>
#include <bit>

namespace abbe {

// A direction as a place on one of two unit squares, one for each hemisphere about ±z: faces of an octahedron,
// unfolded.
struct SphereSquare {
    bool upper = true;
    Vec2 u; // in [0, 1)²

    // Requires a unit vector.
    static SphereSquare of(Vec3 w);
    Vec3 direction() const;
    // Area of the square over the solid angle there, 1/sr.
    static float areaPerSolidAngle(Vec3 w);
};

// Regions of space, the leaves of a binary tree, each with a density over directions: two trees of squares, one for
// each hemisphere [Mueller2017]. Learnt by pilots (guide_training.h) and frozen before the first sample of a render.
class PathGuide {
  public:
    // A square of a hemisphere in 4 × 4 parts, x first.
    struct Square {
        struct Part {
            float density = 0;          // over the unit square, of a part that is not divided
            std::uint16_t radiance = 0; // from there, as Direction::radiance; the upper half of a float
            std::uint16_t child = 0;    // from the first square of the region on; 0: the part is not divided
        };
        std::array<Part, 16> parts{};
    };
    // By what samples choose among the parts of a square.
    struct Sums {
        std::array<float, 3> columns{};             // shares of the first one, two and three columns
        std::array<std::array<float, 3>, 4> rows{}; // of rows in each column
    };
    struct Seen {
        Vec3 w;
        float stretch = 1;
    };
    // Directions are those from the centre of the region to where they reach a sphere about the place they start from:
    // so they follow what is at that distance, be it what gives off light or a gap through which it comes.
    struct Region {
        Vec3 centre;
        float nearness = 0;          // 1 over the radius of the sphere; 0: at infinity
        float guided = 0;            // share of directions that are to be drawn from here; 0: none
        float upper = 0;             // share of the upper hemisphere
        std::uint32_t first = 0;     // of its squares: the lower hemisphere
        std::uint16_t upperRoot = 0; // the upper one, from there on
        bool known = false;          // whether there is anything to look up

        // How a direction from p is seen from the centre, and the solid angles around it there over those from p.
        Seen seen(Vec3 p, Vec3 w) const;
        // The way from the centre to p in radii of the sphere; shorter than one: p may lie beyond.
        Vec3 offset(Vec3 p) const;
    };
    struct Direction {
        Vec3 w;
        float pdf = 0;      // 1/sr
        float radiance = 0; // expected from there, over that of the frame in the mean
    };

    // `regions`: those of the leaves of `space`.
    // `sums`: those of the squares.
    PathGuide(SpaceTree space, std::vector<Region> regions, std::vector<Square> squares, std::vector<Sums> sums)
        : space_(std::move(space)), regions_(std::move(regions)), squares_(std::move(squares)), sums_(std::move(sums)) {
    }

    // Null where nothing is known. `face`: faceOf() the normal of the surface, on the side of the eye.
    const Region* at(Vec3 p, std::uint8_t face) const {
        const Region& region = regions_[space_.leaf(p, face)];
        return region.known ? &region : nullptr;
    }
    Direction look(const Region& region, Vec3 p, Vec3 w) const { return look(region, &squares_[region.first], p, w); }
    // The same with squares that are not in a guide yet: from the first of the region on.
    static Direction look(const Region&, const Square* first, Vec3 p, Vec3 w);
    // u in [0, 1)²; distributed with the pdf.
    Direction sample(const Region&, Vec3 p, Vec2 u) const;

    const std::vector<Region>& regions() const { return regions_; }
    std::size_t bytes() const;

  private:
    SpaceTree space_;
    std::vector<Region> regions_;
    std::vector<Square> squares_;
    std::vector<Sums> sums_;
};

} // namespace abbe

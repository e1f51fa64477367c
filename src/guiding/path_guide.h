// What is known of the light that arrives at places of a scene: by it paths are guided to where light comes from.
#pragma once

#include "guiding/radiance_cache.h"
#include "math/warp.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

namespace abbe {

// A direction as a place on one of two unit squares, one for each hemisphere about ±z: faces of an octahedron,
// unfolded.
struct SphereSquare {
    bool upper = true;
    Vec2 u; // in [0, 1)²

    // With s = |x| + |y| + |z|, v / s lies on a face of the octahedron; seen along z the upper faces fill a square that
    // stands on its corner. `inverse`: 1 / s.
    static SphereSquare of(Vec3 v, float inverse) {
        const float scale = 0.5f * inverse;
        const Vec2 u{0.5f + (v.x + v.y) * scale, 0.5f + (v.y - v.x) * scale};
        return {v.z >= 0, {std::clamp(u.x, 0.f, kOneMinusEpsilon), std::clamp(u.y, 0.f, kOneMinusEpsilon)}};
    }
    // On the octahedron: |x| + |y| + |z| = 1.
    Vec3 onOctahedron() const;
};

// Regions of space, the leaves of a binary tree, each with a density over directions: two trees of squares, one for
// each hemisphere [Mueller2017]. Learnt by pilots (guide_training.h) and frozen before the first sample of a render.
class PathGuide {
  public:
    // A square of a hemisphere in 4 × 4 parts, x first. Two lines of the cache: what is looked up at random waits for
    // memory more than it computes.
    struct alignas(128) Square {
        struct Part {
            float density = 0;          // over the unit square, in the mean
            std::uint16_t radiance = 0; // from there, as Direction::radiance; the upper half of a float
            std::uint16_t child = 0;    // from the first square of the region on; 0: the part is not divided
        };
        std::array<Part, 16> parts{};
    };
    // Directions are those from the centre of the region to where they reach a sphere about the place they start from:
    // so they follow what is at that distance, be it what gives off light or a gap through which it comes.
    struct Region {
        Vec3 centre;
        float nearness = 0;          // 1 over the radius of the sphere; 0: at infinity
        float guided = 0;            // share of directions that are to be drawn from here; 0: none
        float lights = 1;            // share of the vertices at which next-event estimation is worth its ray, above 0
        float upper = 0;             // share of the upper hemisphere
        std::uint32_t first = 0;     // of its squares: the lower hemisphere
        std::uint16_t upperRoot = 0; // the upper one, from there on
        bool known = false;          // whether there is anything to look up

        // The way from the centre to p in radii of the sphere; shorter than one: p may lie beyond.
        Vec3 offset(Vec3 p) const {
            constexpr float kFarthest = 0.8f;
            const Vec3 o = (p - centre) * nearness;
            const float r2 = dot(o, o);
            return r2 <= kFarthest * kFarthest ? o : o * (kFarthest / std::sqrt(r2));
        }
    };
    // How a direction from a place is seen from the centre of its region.
    struct Seen {
        SphereSquare at;
        float area = 0; // of the square, over the solid angle around the direction, 1/sr
    };
    static Seen seen(Vec3 offset, Vec3 w) {
        // Where w reaches the sphere about the place is v = w + offset seen from the centre, and the solid angles there
        // are (w · v) / |v|³ times those from the place. The square has 1/2 (|v| / s)³ for each of them, of which |v|
        // cancels.
        const Vec3 v = w + offset;
        const float inverse = 1 / (std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
        return {SphereSquare::of(v, inverse), 0.5f * dot(w, v) * inverse * inverse * inverse};
    }
    struct Direction {
        Vec3 w;
        float pdf = 0;      // 1/sr
        float radiance = 0; // expected from there, over that of the frame in the mean
    };

    // What is known at a place, which the guide outlives.
    class View {
      public:
        View() = default; // nothing
        View(const PathGuide& guide, const Region& region, Vec3 p)
            : guide_(&guide), region_(&region), offset_(region.offset(p)) {}

        explicit operator bool() const { return region_ != nullptr; }
        const Region& region() const { return *region_; }
        // Share of directions to be drawn from here.
        float guided() const { return region_ ? region_->guided : 0; }
        float lights() const { return region_ ? region_->lights : 1; }
        // Requires that anything is known, as those that follow.
        Direction look(Vec3 w) const {
            return PathGuide::look(*region_, &guide_->squares_[region_->first], offset_, w);
        }
        // u in [0, 1)²; distributed with the pdf.
        Direction sample(Vec2 u) const { return guide_->sample(*region_, offset_, u); }
        // Density of directions of which that share is drawn from here, and all others with the density `own`.
        float mixed(float own, float here) const { return region_->guided * here + (1 - region_->guided) * own; }
        float mixed(float own, Vec3 w) const { return mixed(own, look(w).pdf); }

      private:
        const PathGuide* guide_ = nullptr;
        const Region* region_ = nullptr;
        Vec3 offset_;
    };

    // `regions`: those of the leaves of `space`.
    PathGuide(SpaceTree space, std::vector<Region> regions, std::vector<Square> squares)
        : space_(std::move(space)), regions_(std::move(regions)), squares_(std::move(squares)) {}

    // `face`: faceOf() the normal of the surface, on the side of the eye.
    View at(Vec3 p, std::uint8_t face) const {
        const Region& region = regions_[space_.leaf(p, face)];
        return region.known ? View(*this, region, p) : View();
    }
    // With squares that are not in a guide yet: from the first of the region on.
    static Direction look(const Region&, const Square* first, Vec3 offset, Vec3 w);

    // By which distances in media are drawn; null: as far as they let a path go.
    const RadianceCache* cache() const { return cache_ ? &*cache_ : nullptr; }
    void guideDistances(RadianceCache cache) { cache_ = std::move(cache); }
    void leaveDistances() { cache_.reset(); }

    const std::vector<Region>& regions() const { return regions_; }
    std::size_t bytes() const;

  private:
    Direction sample(const Region&, Vec3 offset, Vec2 u) const;

    SpaceTree space_;
    std::vector<Region> regions_;
    std::vector<Square> squares_;
    std::optional<RadianceCache> cache_;
};

} // namespace abbe

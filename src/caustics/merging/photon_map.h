// The photons of one round of merging, by place: vertices of light paths that wait to be hit by camera paths.
#pragma once

#include "math/bounds.h"
#include "math/vec.h"
#include "render/light.h"
#include "spectrum/spectrum.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

class Medium;

// Light that arrives at a surface, or is scattered in a medium, after a mirror or clear glass was the first thing it
// hit [Jensen1996].
struct Photon {
    Vec3 p;                         // render space
    Vec3 wi;                        // unit, against its flight
    Vec3 ng;                        // geometric normal of the surface, outside; 0 in a medium
    Spectrum flux;                  // W·nm⁻¹ over the density of all before, at the wavelengths of the round
    Spectrum densities;             // as SpectralDensities::unidirectional, by which sums are divided in the mean
    const Medium* medium = nullptr; // that scatters it; null: a surface
    const Light* light = nullptr;   // where it began,
    std::uint32_t target = 0;       // sent to what: as in EmittedRay,
    Vec2 aim;                       // and where in that
    float cameraOdds = 0;       // density of the camera paths that come from the light here, without the scattering at
                                // p, over that of the light paths; 0: there are none
    std::uint32_t vertices = 0; // at which it was scattered on the way
    bool heroOnly = false;      // `flux` and densities are those of the first lane, eight times
    bool followed = false;      // by a chain that manifold sampling covers, if p samples it
    std::uint8_t axis = 0;      // PhotonMap's own
};

// How flux is spread over a disk. The kernel of [Epanechnikov1969] in the plane: 2/(π r²) (1 − d²/r²).
struct DiskKernel {
    float value;  // 1/m²
    float closer; // over that: what the same kernel has over half of the area

    // `x`: square of the distance over the radius, in [0, 1).
    DiskKernel(float x, float radius)
        : value(2 * (1 - x) / (kPi * radius * radius)), closer(x < 0.5f ? 2 * (1 - 2 * x) / (1 - x) : 0) {}
};

// A balanced tree over points, without pointers: the middle photon of a range divides it [Bentley1975]. The order of
// the photons it was made of does not matter as long as no two are at one place.
class PhotonMap {
  public:
    PhotonMap() = default;
    explicit PhotonMap(std::vector<Photon> photons);

    std::size_t size() const { return photons_.size(); }
    // Tells of all photons nearer to p than `radius`, with the square of their distance; in an order that depends on
    // the photons alone.
    template <typename Tell> void near(Vec3 p, float radius, Tell&& tell) const { visit(photons_, p, radius, tell); }

    // Likewise of all photons within a tube: nearer than radius(t) to the place o + t d, with 0 ≤ tNear ≤ t ≤ tFar,
    // that is nearest to them on the line; `tell(photon, t, squared distance)`. `d` is a unit vector, the radius a
    // convex function of t.
    template <typename Radius, typename Tell>
    void along(Vec3 o, Vec3 d, float tNear, float tFar, Radius&& radius, Tell&& tell) const {
        // Tubes without an end reach beyond all photons.
        const float most = dot(bounds_.centre() - o, d) + 2 * bounds_.radius();
        if (!photons_.empty()) visit(photons_, Segment{o, d, tNear, std::min(tFar, most)}, radius, tell);
    }

  private:
    struct Segment {
        Vec3 o, d;
        float t0, t1;
        float at(float t, int axis) const { return o[axis] + t * d[axis]; }
    };
    static void build(std::span<Photon>);

    template <typename Tell> static void visit(std::span<const Photon> range, Vec3 p, float radius, Tell& tell) {
        while (!range.empty()) {
            const std::size_t middle = range.size() / 2;
            const Photon& photon = range[middle];
            const float d2 = lengthSquared(photon.p - p);
            if (d2 < radius * radius) tell(photon, d2);
            const float away = p[photon.axis] - photon.p[photon.axis];
            const std::span<const Photon> below = range.first(middle), above = range.subspan(middle + 1);
            if (std::abs(away) < radius) visit(away < 0 ? above : below, p, radius, tell);
            range = away < 0 ? below : above;
        }
    }

    // A photon is on its side of the plane that divides the range, so what is nearest to it on the line is not farther
    // beyond that plane than the tube is wide.
    template <typename Radius, typename Tell>
    static void visit(std::span<const Photon> range, Segment s, Radius& radius, Tell& tell) {
        constexpr float kRounding = 1 + 1e-4f;
        while (!range.empty() && s.t0 <= s.t1) {
            const std::size_t middle = range.size() / 2;
            const Photon& photon = range[middle];
            const float t = dot(photon.p - s.o, s.d);
            if (t >= s.t0 && t <= s.t1) {
                const float d2 = lengthSquared(photon.p - (s.o + s.d * t));
                if (d2 < square(radius(t))) tell(photon, t, d2);
            }
            const float wide = std::max(radius(s.t0), radius(s.t1)) * kRounding;
            visit(range.first(middle), within(s, photon.axis, photon.p[photon.axis] + wide, false), radius, tell);
            s = within(s, photon.axis, photon.p[photon.axis] - wide, true);
            range = range.subspan(middle + 1);
        }
    }
    // The part of the segment below or above a plane across an axis.
    static Segment within(Segment s, int axis, float plane, bool above) {
        const float slope = s.d[axis], side = above ? 1.f : -1.f;
        const float begin = side * (s.at(s.t0, axis) - plane), end = side * (s.at(s.t1, axis) - plane);
        if (begin >= 0 && end >= 0) return s;
        if (begin < 0 && end < 0) return {s.o, s.d, 1, 0};
        const float t = (plane - s.o[axis]) / slope;
        (begin < 0 ? s.t0 : s.t1) = t;
        return s;
    }

    std::vector<Photon> photons_;
    Bounds3 bounds_;
};

// The photons of one round.
struct PhotonMaps {
    PhotonMap onSurfaces, inMedia;

    explicit PhotonMaps(std::vector<Photon> photons) {
        const auto surfaces = std::ranges::partition(photons, [](const Photon& p) { return p.medium != nullptr; });
        onSurfaces = PhotonMap({surfaces.begin(), surfaces.end()});
        photons.erase(surfaces.begin(), surfaces.end());
        inMedia = PhotonMap(std::move(photons));
    }

    std::size_t size() const { return onSurfaces.size() + inMedia.size(); }
};

} // namespace abbe

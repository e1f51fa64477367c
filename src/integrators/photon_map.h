// Photons by place.
#pragma once

#include "integrators/photon.h"

#include <algorithm>
#include <span>
#include <vector>

namespace abbe {

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

  private:
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

    std::vector<Photon> photons_;
};

} // namespace abbe

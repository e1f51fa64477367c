#include "caustics/merging/photon_map.h"

namespace abbe {

PhotonMap::PhotonMap(std::vector<Photon> photons) : photons_(std::move(photons)) {
    for (const Photon& photon : photons_) bounds_.add(photon.p);
    build(photons_);
}

// Along the longest side.
void PhotonMap::build(std::span<Photon> range) {
    while (range.size() > 1) {
        Bounds3 bounds;
        for (const Photon& photon : range) bounds.add(photon.p);
        const Vec3 size = bounds.diagonal();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = range.size() / 2;
        std::nth_element(range.begin(), range.begin() + static_cast<std::ptrdiff_t>(middle), range.end(),
                         [axis](const Photon& a, const Photon& b) { return a.p[axis] < b.p[axis]; });
        range[middle].axis = static_cast<std::uint8_t>(axis);
        build(range.first(middle));
        range = range.subspan(middle + 1);
    }
}

} // namespace abbe

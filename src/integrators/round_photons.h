// The photons of one round of merging.
#pragma once

#include "integrators/photon_map.h"

namespace abbe {

struct RoundPhotons {
    PhotonMap onSurfaces, inMedia;

    explicit RoundPhotons(std::vector<Photon> photons) {
        const auto surfaces = std::ranges::partition(photons, [](const Photon& p) { return p.medium != nullptr; });
        onSurfaces = PhotonMap({surfaces.begin(), surfaces.end()});
        photons.erase(surfaces.begin(), surfaces.end());
        inMedia = PhotonMap(std::move(photons));
    }

    std::size_t size() const { return onSurfaces.size() + inMedia.size(); }
};

} // namespace abbe

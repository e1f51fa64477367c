// From the sums of layers to the channels of a file.
#pragma once

#include "film/pixel_film.h"
#include "spectrum/color_space.h"

namespace abbe {

// How sums become numbers: as those of the picture.
struct LayerView {
    const RgbSpace* space = nullptr;
    Matrix3 fromXyz;  // of the picture: to the space, with the white balance
    double scale = 1; // exposure
    Vec3d origin;     // world position of the origin of render space
};

struct LayerPlanes {
    std::vector<NamedPlane> planes;
    std::vector<std::pair<std::string, std::string>> header; // attributes that belong to them
    std::size_t unequalSums = 0; // values of groups and components that do not add up to the picture's
};

// `picture`: as resolved with the same view. Its parts add up to it, for which its last bits may change where there are
// parts (film/sum_rounding.h). docs/output.md describes the channels.
LayerPlanes layerPlanes(const PixelFilm&, ResolvedImage& picture, const LayerView&);

} // namespace abbe

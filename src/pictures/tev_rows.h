// The picture of a film in the channels and colours that the viewer tev takes.
#pragma once

#include "pictures/film_picture.h"
#include "tev/tev_image.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

// From colours of this space to linear Rec. 709, which is what tev takes R, G and B for.
Matrix3 tevColours(OutputSpace);

// R, G, B and the film's layers under their names.
std::vector<std::string> tevChannels(FilmPicture&);
// Rows [y0, y1) of the film's frame, in its coordinates: the picture in `space`, and layers with R, G and B, as linear
// Rec. 709; other layers as they are. Nothing if the film has other channels than these.
std::optional<TevRows> tevRows(FilmPicture&, OutputSpace space, const std::vector<std::string>& channels, int y0,
                               int y1);

} // namespace abbe

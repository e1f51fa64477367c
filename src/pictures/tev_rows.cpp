#include "pictures/tev_rows.h"

#include "spectrum/color_space.h"

#include <algorithm>
#include <array>
#include <span>

namespace abbe {

namespace {

using TevTriple = std::array<std::span<float>, 3>;

void convertForTev(const TevTriple& rgb, const Matrix3& matrix) {
    for (std::size_t i = 0; i < rgb[0].size(); ++i) {
        const auto c = matrix.apply<Vec3d>(Vec3d{rgb[0][i], rgb[1][i], rgb[2][i]});
        rgb[0][i] = static_cast<float>(c.x);
        rgb[1][i] = static_cast<float>(c.y);
        rgb[2][i] = static_cast<float>(c.z);
    }
}

// Layers with R, G and B are colours of the film's space; with A beside them they are identifiers of a Cryptomatte.
std::vector<std::size_t> colourLayers(const std::vector<std::string>& channels) {
    std::vector<std::size_t> found;
    const auto has = [&](const std::string& name) { return std::ranges::find(channels, name) != channels.end(); };
    for (std::size_t i = 0; i < channels.size(); ++i)
        if (channels[i].ends_with(".R")) {
            const std::string layer = channels[i].substr(0, channels[i].size() - 1);
            if (has(layer + "G") && has(layer + "B") && !has(layer + "A")) found.push_back(i);
        }
    return found;
}

} // namespace

Matrix3 tevColours(OutputSpace space) { return rgb::rec709.fromXyz() * rgbSpace(space).toXyz(); }

std::vector<std::string> tevChannels(FilmPicture& picture) {
    std::vector<std::string> channels{"R", "G", "B"};
    const int top = picture.image.bounds.y0;
    for (const NamedPlane& plane : picture.rows(top, top).layers.planes) channels.push_back(plane.name);
    return channels;
}

std::optional<TevRows> tevRows(FilmPicture& picture, OutputSpace space, const std::vector<std::string>& channels,
                               int y0, int y1) {
    const PixelBounds bounds = picture.image.bounds;
    const Matrix3 matrix = tevColours(space);
    const auto width = static_cast<std::size_t>(bounds.width());
    TevRows rows{y0, y1, channels, {}, bounds.x0, bounds.x1};
    const std::size_t first = static_cast<std::size_t>(y0 - bounds.y0) * width;
    const std::size_t count = static_cast<std::size_t>(y1 - y0) * width;
    rows.planes.reserve(channels.size() * count);
    const auto add = [&](std::span<const float> values) {
        rows.planes.insert(rows.planes.end(), values.begin(), values.end());
    };
    const LayerPlanes layers = picture.rows(y0, y1).layers; // first: the picture gets its last bits by it
    for (const std::vector<float>* plane : {&picture.image.r, &picture.image.g, &picture.image.b})
        add(std::span(*plane).subspan(first, count));
    for (const NamedPlane& plane : layers.planes) add(plane.values);
    if (rows.planes.size() != channels.size() * count) return std::nullopt;
    const auto channel = [&](std::size_t i) { return std::span(rows.planes).subspan(i * count, count); };
    const auto triple = [&](std::size_t r) {
        const std::string layer = channels[r].substr(0, channels[r].size() - 1);
        const auto find = [&](const char* c) {
            return static_cast<std::size_t>(std::ranges::find(channels, layer + c) - channels.begin());
        };
        return TevTriple{channel(r), channel(find("G")), channel(find("B"))};
    };
    convertForTev(triple(0), matrix);
    for (const std::size_t r : colourLayers(channels)) convertForTev(triple(r), matrix);
    return rows;
}

} // namespace abbe

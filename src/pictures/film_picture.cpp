#include "pictures/film_picture.h"

#include "render/render_state.h"

#include <algorithm>
#include <utility>

namespace abbe {

namespace {

void append(std::vector<float>& to, const std::vector<float>& from) { to.insert(to.end(), from.begin(), from.end()); }

void append(LayerPlanes& to, LayerPlanes from) {
    if (to.planes.empty()) {
        to = std::move(from);
        return;
    }
    for (std::size_t i = 0; i < to.planes.size(); ++i) append(to.planes[i].values, from.planes[i].values);
    to.unequalSums += from.unequalSums;
}

void append(std::optional<DeepImage>& to, DeepImage from) {
    if (!to) {
        to = std::move(from);
        return;
    }
    to->bounds.y1 = from.bounds.y1;
    to->counts.insert(to->counts.end(), from.counts.begin(), from.counts.end());
    for (const auto plane :
         {&DeepImage::front, &DeepImage::back, &DeepImage::a, &DeepImage::r, &DeepImage::g, &DeepImage::b})
        append((*to).*plane, from.*plane);
}

Matrix3 toSpace(const FilmSettings& settings) { return rgbSpace(settings.space).fromXyz() * settings.whiteBalance; }

} // namespace

ResolvedImage resolveImage(const PixelFilm& film, const FilmSettings& settings, double exposure,
                           std::optional<PixelBounds> part) {
    return film.resolve(toSpace(settings), exposure, part);
}

FilmPicture::FilmPicture(const PixelFilm& film, const FilmSettings& settings, double exposure, Vec3d origin,
                         BringLayers bring)
    : image(resolveImage(film, settings, exposure)), film_(film),
      settings_(settings), view_{&rgbSpace(settings.space), toSpace(settings), exposure, origin},
      bring_(std::move(bring)) {}

// Layers that are brought come a row of tiles at a time: their sums take many times what becomes of them.
FilmPicture::Rows FilmPicture::rows(int y0, int y1) {
    Rows result;
    if (!film_.layers()) return result;
    PixelBounds all = image.bounds;
    const int step = bring_ ? TileGrid::kSize : y1 - y0;
    all.y0 = y0;
    do {
        all.y1 = std::min(all.y0 + step, y1);
        if (bring_ && all.y0 < all.y1) bring_(all);
        add(result, all);
        all.y0 = all.y1;
    } while (all.y0 < y1);
    return result;
}

void FilmPicture::add(Rows& to, PixelBounds rows) {
    ResolvedImage part = resolveImage(film_, settings_, view_.scale, rows);
    append(to.layers, layerPlanes(film_, part, view_));
    take(part);
    if (hasDeep()) append(to.deep, deepImage(film_, view_, rows));
}

void FilmPicture::take(const ResolvedImage& part) {
    const PixelBounds& b = part.bounds;
    std::size_t from = 0;
    std::size_t to = static_cast<std::size_t>(b.y0 - image.bounds.y0) * static_cast<std::size_t>(b.width());
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x, ++from, ++to) {
            if (painted && film_.samples(x, y) == 0) continue;
            image.r[to] = part.r[from];
            image.g[to] = part.g[from];
            image.b[to] = part.b[from];
        }
}

} // namespace abbe

#include "film/merged_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace abbe {

namespace {

constexpr int kRadiusTile = 8;
constexpr double kFactor = 1 / (1 - 1 / std::numbers::sqrt2);

struct Tile {
    double luminance = 0, merged = 0;
    double a = 0, b = 0; // the bias, by two halves of the replicates
};

Tile tileOf(const PixelFilm& film, PixelBounds pixels) {
    const int all = film.replicates(), half = all / 2;
    const auto bias = [&](int x, int y, int first, int last) {
        const double wide = film.splatMean(SplatKind::merged, x, y, first, last).y;
        return kFactor * (wide - film.closerMean(x, y, first, last));
    };
    Tile tile;
    for (int y = pixels.y0; y < pixels.y1; ++y)
        for (int x = pixels.x0; x < pixels.x1; ++x) {
            tile.luminance += film.mean(x, y).y;
            tile.merged += film.splatMean(SplatKind::merged, x, y, 0, all).y;
            tile.a += bias(x, y, 0, half > 0 ? half : all);
            tile.b += bias(x, y, half, all);
        }
    return tile;
}

} // namespace

std::optional<MergedLight> MergedLight::of(const PixelFilm& film) {
    MergedLight result;
    result.rounds = film.splatCount(SplatKind::merged, 0, film.replicates());
    if (result.rounds == 0) return std::nullopt;
    const PixelBounds all = film.bounds();
    std::vector<Tile> tiles;
    for (int y = all.y0; y < all.y1; y += kRadiusTile)
        for (int x = all.x0; x < all.x1; x += kRadiusTile)
            tiles.push_back(tileOf(film, {x, y, std::min(x + kRadiusTile, all.x1), std::min(y + kRadiusTile, all.y1)}));
    double luminance = 0, merged = 0, bias = 0, sum = 0, squares = 0;
    for (const Tile& t : tiles) {
        luminance += t.luminance;
        merged += t.merged;
        bias += (t.a + t.b) / 2;
    }
    if (!(luminance > 0)) return result;
    const double least = 0.1 * luminance / static_cast<double>(tiles.size());
    for (const Tile& t : tiles) {
        const double product = t.a * t.b / square(std::max(t.luminance, least));
        sum += product;
        squares += square(product);
    }
    const auto count = static_cast<double>(tiles.size());
    result.share = merged / luminance;
    result.bias = bias / luminance;
    result.biasOfTiles = std::sqrt(std::max(0.0, sum / count) + 2 * std::sqrt(squares) / count);
    return result;
}

} // namespace abbe

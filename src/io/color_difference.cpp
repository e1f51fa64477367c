#include "io/color_difference.h"

#include "base/check.h"
#include "io/display_rgb.h"
#include "spectrum/lab.h"

#include <algorithm>

namespace abbe {

namespace {

constexpr double kMeanLuminance = 0.18;
constexpr int kTile = 8;

// Turns the RGB of an image into Lab.
class Viewing {
  public:
    Viewing(const RgbImage& image, const RgbImage& reference)
        : toXyz_(rgb::rec709.toXyz() * toDisplayRgb(image, reference)) {
        double sum = 0;
        for (std::size_t i = 0; i < reference.rgb.size(); i += 3) sum += xyz(&reference.rgb[i]).y;
        const double mean = sum / (static_cast<double>(reference.rgb.size()) / 3);
        if (mean > 0) scale_ = kMeanLuminance / mean;
    }

    Xyz xyz(const float* rgb) const { return toXyz_.apply<Xyz>(Vec3d{rgb[0], rgb[1], rgb[2]}) * scale_; }
    Lab lab(const Xyz& color) const {
        if (color.y <= 0) return {};
        return toLab(color.y > 1 ? color * (1 / color.y) : color, white_);
    }

  private:
    Matrix3 toXyz_;
    Xyz white_ = whiteXyz(rgb::rec709.white);
    double scale_ = 1;
};

// Calls back with the half-open pixel rectangle of every tile; those at the right and below may be smaller.
template <typename Function> void forTiles(int width, int height, Function&& function) {
    for (int y = 0; y < height; y += kTile)
        for (int x = 0; x < width; x += kTile)
            function(PixelWindow{x, y, std::min(x + kTile, width), std::min(y + kTile, height)});
}

Xyz tileMean(const Viewing& viewing, const RgbImage& image, const PixelWindow& tile) {
    Xyz sum;
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            sum += viewing.xyz(&image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) +
                                               static_cast<std::size_t>(x))]);
    return sum * (1 / static_cast<double>(tile.area()));
}

struct Summary {
    double mean = 0, percentile95 = 0;
};
Summary summarise(std::vector<float> values) {
    Summary s;
    for (const float v : values) s.mean += v;
    s.mean /= static_cast<double>(values.size());
    const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), values.begin() + at, values.end());
    s.percentile95 = values[static_cast<std::size_t>(at)];
    return s;
}

} // namespace

ColorDifference colorDifference(const RgbImage& image, const RgbImage& reference) {
    ABBE_CHECK(image.rgb.size() == reference.rgb.size() && !image.rgb.empty());
    const Viewing viewing(image, reference);
    std::vector<float> pixels(image.rgb.size() / 3), tiles;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = static_cast<float>(
            deltaE2000(viewing.lab(viewing.xyz(&image.rgb[3 * i])), viewing.lab(viewing.xyz(&reference.rgb[3 * i]))));
    forTiles(image.width(), image.height(), [&](const PixelWindow& tile) {
        tiles.push_back(static_cast<float>(
            deltaE2000(viewing.lab(tileMean(viewing, image, tile)), viewing.lab(tileMean(viewing, reference, tile)))));
    });
    const Summary ofPixels = summarise(std::move(pixels)), ofTiles = summarise(std::move(tiles));
    return {ofPixels.mean, ofPixels.percentile95, ofTiles.mean, ofTiles.percentile95};
}

} // namespace abbe

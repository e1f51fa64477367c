#include "io/color_difference.h"

#include "base/check.h"
#include "io/display_rgb.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe {

namespace {

constexpr double kMeanLuminance = 0.18;
constexpr int kTile = 8;
constexpr double kDegree = std::numbers::pi / 180;

double labCurve(double t) {
    constexpr double kKnee = 6.0 / 29;
    return t > kKnee * kKnee * kKnee ? std::cbrt(t) : t / (3 * kKnee * kKnee) + 4.0 / 29;
}

double power7(double v) { return std::pow(v, 7); }

// Hue in degrees, 0 … 360; 0 for greys.
double hueOf(double a, double b) {
    if (a == 0 && b == 0) return 0;
    const double hue = std::atan2(b, a) / kDegree;
    return hue < 0 ? hue + 360 : hue;
}

// The mean of two hues along the shorter arc [Sharma2005, eq. 14]. Requires colours that are not grey.
double meanHue(double h1, double h2) {
    const double sum = h1 + h2;
    if (std::abs(h1 - h2) <= 180) return sum / 2;
    return sum < 360 ? (sum + 360) / 2 : (sum - 360) / 2;
}

// Turns the RGB of an image into Lab.
class Viewing {
  public:
    Viewing(const RgbImage& image, const RgbImage& reference)
        : toXyz_(rgb::rec709.toXyz() *
                 toDisplayRgb(reference.chromaticities ? reference.chromaticities : image.chromaticities)) {
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

Lab toLab(const Xyz& color, const Xyz& white) {
    const double x = labCurve(color.x / white.x), y = labCurve(color.y / white.y), z = labCurve(color.z / white.z);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// [Sharma2005, eqs. 2 to 22].
double deltaE2000(const Lab& p, const Lab& q) {
    const double meanChroma = (std::hypot(p.a, p.b) + std::hypot(q.a, q.b)) / 2;
    const double g = 0.5 * (1 - std::sqrt(power7(meanChroma) / (power7(meanChroma) + power7(25))));
    const double a1 = (1 + g) * p.a, a2 = (1 + g) * q.a;
    const double c1 = std::hypot(a1, p.b), c2 = std::hypot(a2, q.b);
    const double h1 = hueOf(a1, p.b), h2 = hueOf(a2, q.b);
    const bool grey = c1 * c2 == 0;
    double dh = grey ? 0 : h2 - h1;
    if (dh > 180) dh -= 360;
    if (dh < -180) dh += 360;
    const double dL = q.l - p.l, dC = c2 - c1, dH = 2 * std::sqrt(c1 * c2) * std::sin(dh / 2 * kDegree);

    const double l = (p.l + q.l) / 2, c = (c1 + c2) / 2, h = grey ? h1 + h2 : meanHue(h1, h2);
    const double t = 1 - 0.17 * std::cos((h - 30) * kDegree) + 0.24 * std::cos(2 * h * kDegree) +
                     0.32 * std::cos((3 * h + 6) * kDegree) - 0.20 * std::cos((4 * h - 63) * kDegree);
    const double turn = 30 * std::exp(-square((h - 275) / 25));
    const double sL = 1 + 0.015 * square(l - 50) / std::sqrt(20 + square(l - 50));
    const double sC = 1 + 0.045 * c, sH = 1 + 0.015 * c * t;
    const double rotation = -std::sin(2 * turn * kDegree) * 2 * std::sqrt(power7(c) / (power7(c) + power7(25)));
    const double x = dL / sL, y = dC / sC, z = dH / sH;
    return std::sqrt(std::max(0.0, x * x + y * y + z * z + rotation * y * z));
}

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

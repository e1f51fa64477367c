#include "io/flip.h"

#include "base/check.h"
#include "base/parallel.h"
#include "io/image.h"
#include "math/vec.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace abbe {

namespace {

// Values of a function at −radius … radius.
template <typename Function> std::vector<double> sampled(int radius, Function&& function) {
    std::vector<double> values;
    for (int x = -radius; x <= radius; ++x) values.push_back(function(static_cast<double>(x)));
    return values;
}

double sumOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum;
}

std::vector<float> scaled(const std::vector<double>& values, double factor) {
    std::vector<float> result;
    for (const double v : values) result.push_back(static_cast<float>(v * factor));
    return result;
}

// Positive weights add up to 1 and negative ones to −1, so that no detector exceeds 1 on values 0 … 1.
std::vector<float> balanced(const std::vector<double>& values) {
    double positive = 0, negative = 0;
    for (const double v : values) (v > 0 ? positive : negative) += std::abs(v);
    std::vector<float> result;
    for (const double v : values) result.push_back(static_cast<float>(v / (v > 0 ? positive : negative)));
    return result;
}

} // namespace

FlipFilters::FlipFilters(double pixelsPerDegree) {
    // The sensitivities in frequency, sums of Gaussians a √(π/b) exp(−π² x²/b) in degrees [Andersson2020, table 1].
    constexpr double kAchromatic = 0.0047, kRedGreen = 0.0053, kYellowWide = 0.04, kYellowNarrow = 0.025;
    constexpr double kYellowWideHeight = 34.1, kYellowNarrowHeight = 13.5;
    const int eye = static_cast<int>(std::ceil(3 * std::sqrt(kYellowWide / (2 * kPiD * kPiD)) * pixelsPerDegree));
    const auto gaussian = [&](double b) {
        return sampled(eye, [&](double x) { return std::exp(-square(kPiD * x / pixelsPerDegree) / b); });
    };
    const std::vector<double> a = gaussian(kAchromatic), r = gaussian(kRedGreen);
    achromatic_ = scaled(a, 1 / sumOf(a));
    redGreen_ = scaled(r, 1 / sumOf(r));
    // Two separable kernels whose sum is 1: each carries the root of its weight along either axis.
    const std::vector<double> wide = gaussian(kYellowWide), narrow = gaussian(kYellowNarrow);
    const double wideHeight = kYellowWideHeight * std::sqrt(kPiD / kYellowWide);
    const double narrowHeight = kYellowNarrowHeight * std::sqrt(kPiD / kYellowNarrow);
    const double total = wideHeight * square(sumOf(wide)) + narrowHeight * square(sumOf(narrow));
    wideYellow_ = scaled(wide, std::sqrt(wideHeight / total));
    narrowYellow_ = scaled(narrow, std::sqrt(narrowHeight / total));

    constexpr double kFeatureWidth = 0.082; // degrees from peak to trough of the edge detector
    const double sigma = 0.5 * kFeatureWidth * pixelsPerDegree;
    const int feature = static_cast<int>(std::ceil(3 * sigma));
    const auto bell = [&](double x) { return std::exp(-x * x / (2 * sigma * sigma)); };
    const std::vector<double> blur = sampled(feature, bell);
    featureBlur_ = scaled(blur, 1 / sumOf(blur));
    edge_ = balanced(sampled(feature, [&](double x) { return -x * bell(x); }));
    point_ = balanced(sampled(feature, [&](double x) { return (square(x / sigma) - 1) * bell(x); }));
    radius_ = std::max(eye, feature);
}

std::vector<float> FlipFilters::separable(const FlipPlane& plane, const Kernel& alongX, const Kernel& alongY) const {
    const int rx = static_cast<int>(alongX.size()) / 2, ry = static_cast<int>(alongY.size()) / 2;
    const int width = plane.width, wanted = plane.height - 2 * radius_;
    FlipPlane across(width, wanted + 2 * ry);
    std::vector<float> padded(static_cast<std::size_t>(width + 2 * rx));
    for (int y = 0; y < across.height; ++y) {
        const float* from = plane.row(y + radius_ - ry);
        std::fill_n(padded.begin(), rx, from[0]);
        std::copy_n(from, width, padded.begin() + rx);
        std::fill_n(padded.begin() + rx + width, rx, from[width - 1]);
        float* to = across.row(y);
        for (std::size_t k = 0; k < alongX.size(); ++k)
            for (int x = 0; x < width; ++x) to[x] += alongX[k] * padded[k + static_cast<std::size_t>(x)];
    }
    FlipPlane result(width, wanted);
    for (int y = 0; y < wanted; ++y)
        for (std::size_t k = 0; k < alongY.size(); ++k) {
            const float* from = across.row(y + static_cast<int>(k));
            float* to = result.row(y);
            for (int x = 0; x < width; ++x) to[x] += alongY[k] * from[x];
        }
    return std::move(result.values);
}

std::vector<float> FlipFilters::features(const FlipPlane& plane, const Kernel& detector) const {
    std::vector<float> x = separable(plane, detector, featureBlur_);
    const std::vector<float> y = separable(plane, featureBlur_, detector);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
    return x;
}

std::vector<float> FlipFilters::achromatic(const FlipPlane& p) const { return separable(p, achromatic_, achromatic_); }
std::vector<float> FlipFilters::redGreen(const FlipPlane& p) const { return separable(p, redGreen_, redGreen_); }

std::vector<float> FlipFilters::blueYellow(const FlipPlane& p) const {
    std::vector<float> sum = separable(p, wideYellow_, wideYellow_);
    const std::vector<float> narrow = separable(p, narrowYellow_, narrowYellow_);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += narrow[i];
    return sum;
}

std::vector<float> FlipFilters::edges(const FlipPlane& p) const { return features(p, edge_); }
std::vector<float> FlipFilters::points(const FlipPlane& p) const { return features(p, point_); }

namespace {

constexpr int kStripRows = 96;

// The curve of [Andersson2021]: Narkowicz' fit to the ACES view with its exposure of 0.6 undone.
struct ToneCurve {
    static constexpr double a = 0.36 * 2.51, b = 0.6 * 0.03, c = 0.36 * 2.43, d = 0.6 * 0.59, e = 0.14;

    static double apply(double x) { return std::clamp(x * (a * x + b) / (x * (c * x + d) + e), 0.0, 1.0); }
    // The x that is shown as y.
    static double inverse(double y) {
        const double half = 0.5 * (b - y * d) / (a - y * c), rest = -y * e / (a - y * c);
        return -half + std::sqrt(half * half - rest);
    }
};

// A picture whose pixels are asked for one by one, as display values 0 … 1.
using Pixels = std::function<Vec3d(std::size_t pixel)>;

// HyAB between colours in Lab whose chroma is weighed by their lightness (Hunt's effect) [Andersson2020, eqs. 6, 7].
double huntHyab(const Lab& p, const Lab& q) {
    const double wp = 0.01 * p.l, wq = 0.01 * q.l;
    return std::abs(p.l - q.l) + std::hypot(wp * p.a - wq * q.a, wp * p.b - wq * q.b);
}

// What is the same for all pixels of all images.
class Model {
  public:
    explicit Model(double pixelsPerDegree) : filters(pixelsPerDegree) {
        largest_ = std::pow(huntHyab(labOf({0, 1, 0}), labOf({0, 0, 1})), kColorExponent);
    }

    Lab labOf(const Vec3d& rgb) const { return toLab(toXyz_.apply<Xyz>(rgb), white_); }
    // Linear light in the opponent space of the filters: y, x − y and y − z of XYZ relative to the white.
    Vec3d opponent(const Vec3d& rgb) const {
        const Xyz c = toXyz_.apply<Xyz>(rgb);
        const double x = c.x / white_.x, z = c.z / white_.z;
        return {c.y, x - c.y, c.y - z};
    }
    Vec3d fromOpponent(const Vec3d& v) const {
        const Vec3d rgb = fromXyz_.apply<Vec3d>(Xyz{(v.x + v.y) * white_.x, v.x, (v.x - v.z) * white_.z});
        return {std::clamp(rgb.x, 0.0, 1.0), std::clamp(rgb.y, 0.0, 1.0), std::clamp(rgb.z, 0.0, 1.0)};
    }
    // The colour difference, compressed so that large ones share little of the range [Andersson2020, eq. 8].
    double color(const Lab& p, const Lab& q) const {
        constexpr double kKnee = 0.4, kKneeValue = 0.95;
        const double d = std::pow(huntHyab(p, q), kColorExponent), knee = kKnee * largest_;
        return d < knee ? kKneeValue * d / knee : kKneeValue + (1 - kKneeValue) * (d - knee) / (largest_ - knee);
    }
    // Colour and feature differences together [Andersson2020, eqs. 9, 10].
    static double pixel(double color, double feature) {
        return std::min(1.0, std::pow(color, 1 - std::sqrt(feature / std::sqrt(2.0))));
    }

    const FlipFilters filters;

  private:
    static constexpr double kColorExponent = 0.7;
    Matrix3 toXyz_ = rgb::rec709.toXyz(), fromXyz_ = rgb::rec709.fromXyz();
    Xyz white_ = whiteXyz(rgb::rec709.white);
    double largest_ = 0;
};

// What the observer makes of one picture, for some rows of it.
struct Percept {
    std::array<std::vector<float>, 3> opponent; // filtered by what the eye resolves
    std::vector<float> edges, points;           // strength of features
};

Percept percept(const Model& model, const Pixels& pixels, int width, int height, int y0, int y1) {
    const int margin = model.filters.radius();
    std::array<FlipPlane, 3> planes;
    for (FlipPlane& plane : planes) plane = FlipPlane(width, y1 - y0 + 2 * margin);
    for (int row = 0; row < planes[0].height; ++row) {
        const int y = std::clamp(y0 - margin + row, 0, height - 1);
        for (int x = 0; x < width; ++x) {
            const std::size_t at =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            const Vec3d v = model.opponent(pixels(at));
            planes[0].row(row)[x] = static_cast<float>(v.x);
            planes[1].row(row)[x] = static_cast<float>(v.y);
            planes[2].row(row)[x] = static_cast<float>(v.z);
        }
    }
    Percept p;
    p.edges = model.filters.edges(planes[0]);
    p.points = model.filters.points(planes[0]);
    p.opponent = {model.filters.achromatic(planes[0]), model.filters.redGreen(planes[1]),
                  model.filters.blueYellow(planes[2])};
    return p;
}

Lab labAt(const Model& model, const Percept& p, std::size_t i) {
    return model.labOf(model.fromOpponent({p.opponent[0][i], p.opponent[1][i], p.opponent[2][i]}));
}

// LDR-FLIP of a strip of rows; `map` gets the larger of what it holds and the result.
void raiseStrip(const Model& model, const Pixels& a, const Pixels& b, const PixelWindow& strip, int height,
                std::vector<float>& map) {
    const Percept p = percept(model, a, strip.width(), height, strip.y0, strip.y1);
    const Percept q = percept(model, b, strip.width(), height, strip.y0, strip.y1);
    const std::size_t first = static_cast<std::size_t>(strip.y0) * static_cast<std::size_t>(strip.width());
    for (std::size_t i = 0; i < strip.area(); ++i) {
        const double feature = std::max(std::abs(p.edges[i] - q.edges[i]), std::abs(p.points[i] - q.points[i]));
        const double flip = Model::pixel(model.color(labAt(model, p, i), labAt(model, q, i)), feature);
        map[first + i] = std::max(map[first + i], static_cast<float>(flip));
    }
}

void raise(const Model& model, const Pixels& a, const Pixels& b, int width, int height, std::vector<float>& map) {
    const int strips = (height + kStripRows - 1) / kStripRows;
    parallelFor(static_cast<std::size_t>(strips), [&](std::size_t i) {
        const int y0 = static_cast<int>(i) * kStripRows;
        raiseStrip(model, a, b, {0, y0, width, std::min(y0 + kStripRows, height)}, height, map);
    });
}

std::vector<float> displayRgb(const RgbImage& image, const Matrix3& matrix) {
    std::vector<float> result(image.rgb.size());
    for (std::size_t i = 0; i < result.size(); i += 3) {
        const Vec3d rgb = matrix.apply<Vec3d>(Vec3d{image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]});
        // Negative components cannot be shown.
        result[i] = static_cast<float>(std::max(rgb.x, 0.0));
        result[i + 1] = static_cast<float>(std::max(rgb.y, 0.0));
        result[i + 2] = static_cast<float>(std::max(rgb.z, 0.0));
    }
    return result;
}

// Start and stop [Andersson2021, section 3.2]. The median is that of the pixels that are not black where more than half
// are; for a black reference one exposure is as good as another.
void setExposures(HdrFlip& flip, const std::vector<float>& reference) {
    const Matrix3 toXyz = rgb::rec709.toXyz();
    std::vector<double> luminances;
    for (std::size_t i = 0; i < reference.size(); i += 3)
        luminances.push_back(toXyz.m[1][0] * reference[i] + toXyz.m[1][1] * reference[i + 1] +
                             toXyz.m[1][2] * reference[i + 2]);
    const auto median = [&] {
        // Of an even number the mean of the two in the middle.
        const auto middle = luminances.begin() + std::ssize(luminances) / 2;
        std::nth_element(luminances.begin(), middle, luminances.end());
        return luminances.size() % 2 ? *middle : (*middle + *std::max_element(luminances.begin(), middle)) / 2;
    };
    double typical = median();
    if (typical <= 0) {
        std::erase_if(luminances, [](double v) { return v <= 0; });
        typical = luminances.empty() ? 0 : median();
    }
    constexpr double kShown = 0.85;
    if (typical > 0) {
        const double x = ToneCurve::inverse(kShown);
        flip.startExposure = std::log2(x / *std::max_element(luminances.begin(), luminances.end()));
        flip.stopExposure = std::log2(x / typical);
    }
    flip.exposures = std::max(2, static_cast<int>(std::ceil(flip.stopExposure - flip.startExposure)));
}

} // namespace

std::vector<float> ldrFlip(const RgbImage& image, const RgbImage& reference, double pixelsPerDegree) {
    ABBE_CHECK(image.rgb.size() == reference.rgb.size() && pixelsPerDegree >= 1 && pixelsPerDegree <= 1000);
    const auto pixels = [](const RgbImage& from) {
        return [&from](std::size_t i) {
            const float* rgb = &from.rgb[3 * i];
            return Vec3d{std::clamp(rgb[0], 0.0f, 1.0f), std::clamp(rgb[1], 0.0f, 1.0f),
                         std::clamp(rgb[2], 0.0f, 1.0f)};
        };
    };
    std::vector<float> map(image.rgb.size() / 3);
    raise(Model(pixelsPerDegree), pixels(image), pixels(reference), image.width(), image.height(), map);
    return map;
}

HdrFlip hdrFlip(const RgbImage& image, const RgbImage& reference, double pixelsPerDegree) {
    ABBE_CHECK(image.rgb.size() == reference.rgb.size() && !image.rgb.empty() && pixelsPerDegree >= 1 &&
               pixelsPerDegree <= 1000);
    const Matrix3 matrix = toDisplayRgb(image, reference);
    const std::vector<float> a = displayRgb(image, matrix), b = displayRgb(reference, matrix);
    const Model model(pixelsPerDegree);
    HdrFlip flip;
    flip.map.assign(image.rgb.size() / 3, 0);
    setExposures(flip, b);
    for (int k = 0; k < flip.exposures; ++k) {
        const double step = (flip.stopExposure - flip.startExposure) / (flip.exposures - 1);
        const double gain = std::exp2(flip.startExposure + k * step);
        const auto pixels = [gain](const std::vector<float>& rgb) {
            return [gain, &rgb](std::size_t i) {
                return Vec3d{ToneCurve::apply(gain * rgb[3 * i]), ToneCurve::apply(gain * rgb[3 * i + 1]),
                             ToneCurve::apply(gain * rgb[3 * i + 2])};
            };
        };
        raise(model, pixels(a), pixels(b), image.width(), image.height(), flip.map);
    }
    for (const float v : flip.map) flip.mean += v;
    flip.mean /= static_cast<double>(flip.map.size());
    return flip;
}

} // namespace abbe

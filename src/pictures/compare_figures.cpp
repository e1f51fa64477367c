#include "pictures/compare_figures.h"

#include "base/check.h"
#include "io/exr_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>

namespace abbe {

namespace {

bool isExr(const std::string& path) {
    constexpr char kExrMagic[4] = {0x76, 0x2f, 0x31, 0x01};
    char bytes[4] = {};
    std::ifstream file(path, std::ios::binary);
    return file.read(bytes, 4) && std::equal(bytes, bytes + 4, kExrMagic);
}

int replicatesOf(const ExrInfo& info) {
    for (const ImageAttribute& attribute : info.attributes)
        if (attribute.name == "abbe.replicates")
            if (const auto* value = std::get_if<std::int32_t>(&attribute.value)) return std::max(2, *value);
    return 2;
}

} // namespace

CompareImage CompareImage::read(const std::string& path) {
    CompareImage image;
    image.path = path;
    image.picture = readImage(path);
    // A sum of floats is as exact as its terms; a few units in the last place come from the arithmetic of the film.
    image.rounding = 0x1p-22;
    if (!isExr(path)) return image;
    const ExrInfo info = readExrInfo(path);
    for (const ExrInfo::Channel& channel : info.channels) {
        if (channel.type == "half" && channel.name != "variance.Y") image.rounding = 0x1p-11;
        if (channel.name == "variance.Y") image.variance = readExrChannel(path, channel.name);
    }
    image.replicates = replicatesOf(info);
    return image;
}

CompareImage CompareImage::mean(std::span<const CompareImage> images) {
    ABBE_CHECK(!images.empty());
    CompareImage result = images[0];
    const auto n = static_cast<float>(images.size());
    for (const CompareImage& image : images.subspan(1)) {
        for (std::size_t i = 0; i < result.picture.rgb.size(); ++i) result.picture.rgb[i] += image.picture.rgb[i];
        if (image.variance.empty()) result.variance.clear();
        for (std::size_t i = 0; i < result.variance.size(); ++i) result.variance[i] += image.variance[i];
        result.replicates = std::min(result.replicates, image.replicates);
        result.rounding = std::max(result.rounding, image.rounding);
        result.path += ", " + image.path;
    }
    for (float& v : result.picture.rgb) v /= n;
    for (float& v : result.variance) v /= n * n;
    return result;
}

std::vector<float> CompareImage::luminance() const {
    const Matrix3 m = (picture.chromaticities ? picture.chromaticities->space() : rgb::rec709).toXyz();
    std::vector<float> y(picture.rgb.size() / 3);
    for (std::size_t i = 0; i < y.size(); ++i)
        y[i] = static_cast<float>(m.m[1][0] * picture.rgb[3 * i] + m.m[1][1] * picture.rgb[3 * i + 1] +
                                  m.m[1][2] * picture.rgb[3 * i + 2]);
    return y;
}

std::optional<TileTest> tileTest(const CompareImage& image, const CompareImage& reference) {
    if (image.variance.empty() || reference.variance.empty()) return std::nullopt;
    const std::vector<float> a = image.luminance(), b = reference.luminance();
    return tileTest({a, image.variance, image.replicates, image.rounding},
                    {b, reference.variance, reference.replicates, reference.rounding}, image.picture.width(),
                    image.picture.height());
}

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

using Figures = CompareFigures;

double deltaE(const Figures& f, double ColorDifference::*member) { return f.color ? (*f.color).*member : kUnknown; }

constexpr CompareFigure kFigures[] = {
    {"relmse", "relMSE", "{:.6g}", false, [](const Figures& f) { return f.difference.relMse; }},
    {"relmse-trimmed", "  without the worst 0.1 %", "{:.6g}", false,
     [](const Figures& f) { return f.difference.relMseWithoutTail; }},
    {"mse", "MSE", "{:.6g}", false, [](const Figures& f) { return f.difference.mse; }},
    {"psnr", "PSNR, dB", "{:.2f}", true, [](const Figures& f) { return f.difference.psnr; }},
    {"flip", "HDR-FLIP", "{:.6f}", false, [](const Figures& f) { return f.flip ? f.flip->mean : kUnknown; }},
    {"delta-e", "ΔE2000, mean", "{:.4g}", false, [](const Figures& f) { return deltaE(f, &ColorDifference::mean); }},
    {"delta-e-95", "  95 % are below", "{:.4g}", false,
     [](const Figures& f) { return deltaE(f, &ColorDifference::percentile95); }},
    {"delta-e-tiles", "ΔE2000 of 8×8 means, mean", "{:.4g}", false,
     [](const Figures& f) { return deltaE(f, &ColorDifference::tileMean); }},
    {"delta-e-tiles-95", "  95 % are below", "{:.4g}", false,
     [](const Figures& f) { return deltaE(f, &ColorDifference::tilePercentile95); }},
    {"maximum", "largest difference", "{:.6g}", false, [](const Figures& f) { return f.difference.maximum; }},
    {"mean-error", "|mean ratio − 1|", "{:.6f}", false,
     [](const Figures& f) { return std::abs(f.difference.meanRatio - 1); }},
    {"non-finite", "pixels not finite", "{:.0f}", false,
     [](const Figures& f) { return static_cast<double>(f.difference.nonFinite); }},
    {"agreement", "probability of the tile test", "{:.3g}", true,
     [](const Figures& f) {
         return f.tiles && f.tiles->tiles + f.tiles->noiseless > 0 ? f.tiles->probability() : kUnknown;
     }},
};

Json tileJson(const TileTest& t) {
    return Json::object({{"tiles", t.tiles},
                         {"noiseless", t.noiseless},
                         {"skipped", t.skipped},
                         {"unequal", t.unequal},
                         {"mean", t.mean},
                         {"deviation", t.deviation},
                         {"kolmogorov", t.kolmogorov},
                         {"kolmogorov_probability", t.kolmogorovProbability},
                         {"largest", t.largest},
                         {"largest_probability", t.largestProbability},
                         {"largest_x", t.largestX},
                         {"largest_y", t.largestY},
                         {"verdict", t.verdict()}});
}

} // namespace

CompareFigures CompareFigures::measure(const CompareImage& image, std::span<const CompareImage> references,
                                       const CompareImage& reference, double pixelsPerDegree) {
    CompareFigures f;
    f.difference = compare(image.picture, reference.picture);
    f.unbiased = references.size() == 2;
    f.pixelsPerDegree = pixelsPerDegree;
    if (f.unbiased) f.difference.relMse = unbiasedRelMse(image.picture, references[0].picture, references[1].picture);
    f.tiles = tileTest(image, reference);
    if (f.difference.nonFinite > 0) return f;
    f.flip = hdrFlip(image.picture, reference.picture, pixelsPerDegree);
    f.color = colorDifference(image.picture, reference.picture);
    return f;
}

Json CompareFigures::json() const {
    const ImageDifference& d = difference;
    Json json = Json::object({{"mse", d.mse},
                              {"rel_mse", d.relMse},
                              {"unbiased", unbiased},
                              {"rel_mse_without_tail", d.relMseWithoutTail},
                              {"psnr", d.psnr},
                              {"maximum", d.maximum},
                              {"mean_ratio", d.meanRatio},
                              {"non_finite", d.nonFinite}});
    json.set("flip", flip ? Json::object({{"mean", flip->mean},
                                          {"start_exposure", flip->startExposure},
                                          {"stop_exposure", flip->stopExposure},
                                          {"exposures", flip->exposures},
                                          {"pixels_per_degree", pixelsPerDegree}})
                          : Json());
    json.set("delta_e", color ? Json::object({{"mean", color->mean},
                                              {"percentile_95", color->percentile95},
                                              {"tile_mean", color->tileMean},
                                              {"tile_percentile_95", color->tilePercentile95},
                                              {"white", "D65"}})
                              : Json());
    json.set("tile_test", tiles ? tileJson(*tiles) : Json());
    return json;
}

std::string CompareFigure::text(const CompareFigures& figures) const {
    const double v = value(figures);
    return std::isnan(v) ? "–" : fmt::format(fmt::runtime(format), v);
}

bool CompareFigure::within(const CompareFigures& figures, double bound) const {
    const double v = value(figures);
    return atLeast ? v >= bound : v <= bound;
}

std::span<const CompareFigure> compareFigures() { return kFigures; }

const CompareFigure* findCompareFigure(std::string_view name) {
    for (const CompareFigure& figure : kFigures)
        if (figure.name == name) return &figure;
    return nullptr;
}

} // namespace abbe

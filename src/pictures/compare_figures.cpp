#include "pictures/compare_figures.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace abbe {

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

#include "integrators/light_path_forecast.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// Light paths that no camera path can be have a rho of 0.
double total(double rho, double share) { return std::max(rho + share, 1e-12); }

} // namespace

LightPathForecast::LightPathForecast(std::span<const LightDeposit> deposits, PixelBounds frame,
                                     const NoiseMeasure& measure)
    : measure_(measure), pixels_(static_cast<double>(frame.area())) {
    terms_.reserve(deposits.size());
    for (const LightDeposit& d : deposits) {
        const double u = d.luminance * std::sqrt(measure.weight(d.x, d.y)) * d.stands;
        terms_.push_back({static_cast<std::uint32_t>(measure.cell(d.x, d.y)), u, u * u / d.stands, d.rho});
    }
}

double LightPathForecast::secondMoment(const LightDeposit& d, double share) const {
    return square(d.luminance) * measure_.weight(d.x, d.y) * d.stands / total(d.rho, share) / pixels_;
}

double LightPathForecast::light(double share) const {
    double sum = 0;
    for (const Term& t : terms_) sum += t.u2 * share / square(total(t.rho, share));
    return sum / pixels_; // they are many for a pixel and bring little each: their second moment is their variance
}

double LightPathForecast::cameraSecondMoment(double share) const {
    double sum = 0;
    for (const Term& t : terms_) sum += t.u2 * (share > 0 ? t.rho / square(t.rho + share) : 1 / total(t.rho, 0));
    return sum / pixels_;
}

// The square of the mean of what camera paths bring of it: their variance is what lies above. In cells of the frame,
// each without bias: the square of a sum of independent terms less their squares.
double LightPathForecast::squaredMean(double share) const {
    constexpr auto kCells = static_cast<double>(NoiseMeasure::kCells);
    std::vector<double> sums(NoiseMeasure::kCells), squares(sums.size());
    for (const Term& t : terms_) {
        const double found = t.u * (share > 0 ? t.rho / (t.rho + share) : 1);
        sums[t.cell] += found;
        squares[t.cell] += square(found);
    }
    double sum = 0;
    for (std::size_t i = 0; i < sums.size(); ++i)
        sum += (square(sums[i]) - squares[i]) * square(kCells / pixels_) / kCells;
    return sum;
}

double LightPathForecast::camera(double share) const {
    return std::max(0.0, cameraSecondMoment(share) - squaredMean(share));
}

double LightPathForecast::variance(double share, const StratifiedVariance& alone) const {
    const double foretold = camera(0);
    if (foretold > alone.one) // what is too rare to be met by a pilot loses nothing by stratification
        return (1 - (alone.one - std::min(alone.one, alone.many)) / foretold) * camera(share) + light(share);
    // Light that camera paths find well is known better from them: above it is a small difference of large numbers.
    const double all = cameraSecondMoment(0);
    return (all > 0 ? alone.many * cameraSecondMoment(share) / all : 0) + light(share);
}

} // namespace abbe

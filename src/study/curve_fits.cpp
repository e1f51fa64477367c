#include "study/curve_fits.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace abbe {

namespace {

// y = a + b x with weights; b = 0 if x does not vary.
struct Line {
    double a = 0, b = 0;
    bool sloped = false;
};

template <typename X, typename Y, typename W> Line fitLine(std::size_t n, const X& x, const Y& y, const W& w) {
    double sw = 0, sx = 0, sy = 0;
    for (std::size_t i = 0; i < n; ++i) {
        sw += w(i);
        sx += w(i) * x(i);
        sy += w(i) * y(i);
    }
    const double mx = sx / sw, my = sy / sw;
    double sxx = 0, sxy = 0; // about the means, so that nothing cancels
    for (std::size_t i = 0; i < n; ++i) {
        sxx += w(i) * (x(i) - mx) * (x(i) - mx);
        sxy += w(i) * (x(i) - mx) * (y(i) - my);
    }
    if (!(sxx > 0)) return {my, 0, false};
    return {my - sxy / sxx * mx, sxy / sxx, true};
}

struct Floored {
    FlooredLaw law;
    double squares = std::numeric_limits<double>::infinity();
};

Floored withPower(double power, std::span<const double> x, std::span<const double> y, std::span<const double> errors) {
    std::vector<double> powers; // once: they are what takes the time
    for (const double v : x) powers.push_back(std::pow(v / x[0], power));
    const auto fallen = [&](std::size_t i) { return powers[i]; };
    const auto height = [&](std::size_t i) { return y[i]; };
    const auto weight = [&](std::size_t i) { return 1 / (errors[i] * errors[i]); };
    Line line = fitLine(x.size(), fallen, height, weight);
    if (line.b < 0) { // an error that rises with samples is reported as a flat one
        double sw = 0, sy = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            sw += weight(i);
            sy += weight(i) * y[i];
        }
        line = {sy / sw, 0, false};
    }
    Floored result{{line.a, line.b * std::pow(x[0], -power), power}, 0};
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double off = y[i] - line.a - line.b * fallen(i);
        result.squares += weight(i) * off * off;
    }
    return result;
}

} // namespace

std::optional<PowerLaw> PowerLaw::fit(std::span<const double> x, std::span<const double> y,
                                      std::span<const double> weights) {
    ABBE_CHECK(x.size() == y.size() && x.size() == weights.size());
    const auto positive = [](double v) { return v > 0; };
    if (x.size() < 2 || !std::all_of(x.begin(), x.end(), positive) || !std::all_of(y.begin(), y.end(), positive))
        return std::nullopt;
    const Line line = fitLine(
        x.size(), [&](std::size_t i) { return std::log(x[i]); }, [&](std::size_t i) { return std::log(y[i]); },
        [&](std::size_t i) { return weights[i]; });
    if (!line.sloped) return std::nullopt;
    return PowerLaw{line.b, line.a};
}

// The sum of squares as a function of the power alone is smooth: a grid finds its valley, golden sections its bottom.
std::optional<FlooredLaw> FlooredLaw::fit(std::span<const double> x, std::span<const double> y,
                                          std::span<const double> errors) {
    ABBE_CHECK(x.size() == y.size() && x.size() == errors.size());
    if (x.size() < 4) return std::nullopt;
    constexpr int kGrid = 12;
    constexpr double kStep = (kFlattest - kSteepest) / kGrid;
    Floored best;
    for (int i = 0; i <= kGrid; ++i)
        if (const Floored here = withPower(kSteepest + i * kStep, x, y, errors); here.squares < best.squares)
            best = here;
    double low = std::max(kSteepest, best.law.power - kStep), high = std::min(kFlattest, best.law.power + kStep);
    constexpr double kGolden = 0.6180339887498949;
    double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    Floored atLeft = withPower(left, x, y, errors), atRight = withPower(right, x, y, errors);
    for (int i = 0; i < 16; ++i) {
        if (atLeft.squares <= atRight.squares) {
            high = right;
            right = left;
            atRight = atLeft;
            left = high - kGolden * (high - low);
            atLeft = withPower(left, x, y, errors);
        } else {
            low = left;
            left = right;
            atLeft = atRight;
            right = low + kGolden * (high - low);
            atRight = withPower(right, x, y, errors);
        }
    }
    for (const Floored& f : {atLeft, atRight})
        if (f.squares < best.squares) best = f;
    return best.law;
}

std::optional<TimeModel> TimeModel::fit(std::span<const double> samples, std::span<const double> seconds) {
    ABBE_CHECK(samples.size() == seconds.size());
    if (samples.size() < 2) return std::nullopt;
    double w = 0, x = 0, y = 0, xx = 0, xy = 0; // sums with the weights 1/seconds²
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!(seconds[i] > 0)) return std::nullopt;
        const double weight = 1 / (seconds[i] * seconds[i]);
        w += weight;
        x += weight * samples[i];
        y += weight * seconds[i];
        xx += weight * samples[i] * samples[i];
        xy += weight * samples[i] * seconds[i];
    }
    const double determinant = w * xx - x * x;
    if (!(determinant > 1e-12 * w * xx)) return std::nullopt;
    TimeModel model{(xx * y - x * xy) / determinant, (w * xy - x * y) / determinant};
    if (model.fixed < 0) model = {0, xy / xx};
    if (!(model.perSample > 0)) return std::nullopt;
    return model;
}

} // namespace abbe

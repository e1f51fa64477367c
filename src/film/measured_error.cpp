#include "film/measured_error.h"

#include "base/check.h"
#include "film/error_figure.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr double kNormal95 = 1.959964;

double displayCode(float v) { return 255 * std::clamp(static_cast<double>(v), 0.0, 1.0); }

// Adds up what pixels say about the squared error, and about what noise of references leaves of uncertainty in it.
struct SquareSum {
    double value = 0, variance = 0, noise = 0;
    std::size_t pixels = 0;

    // d² = (x − t)² is the squared difference from a reference with the estimated variance v, w the weight of the
    // measure. With t = truth + e the term (x − t)² − v varies by 4 (x − truth)² σ² + 4 σ⁴ for normal e and a v of one
    // degree of freedom, for which v² expects 3 σ⁴; d² v expects no less than (x − truth)² σ².
    void add(double difference, double v, double w) {
        const double d2 = square(difference);
        value += w * (d2 - v);
        variance += square(w) * (4 * d2 * v + 4.0 / 3 * square(v));
        noise += w * v;
        ++pixels;
    }
    MeasuredSquare mean() const {
        const double n = static_cast<double>(std::max<std::size_t>(pixels, 1));
        return {value / n, std::sqrt(variance) / n, noise / n};
    }
};

// The display's curve is not known here, so the noise of both is that of their differences.
MeasuredSquare displaySquare(const MeasuredError::Planes& image, const MeasuredError::Planes& a,
                             const MeasuredError::Planes& b) {
    SquareSum sum;
    for (std::size_t c = 0; c < image.display.size(); ++c) {
        const double x = displayCode(image.display[c]), ta = displayCode(a.display[c]), tb = displayCode(b.display[c]);
        sum.add(x - (ta + tb) / 2, square((ta - tb) / 2), 1);
    }
    MeasuredSquare mean = sum.mean();
    mean.standardError *= std::sqrt(3.0); // the three values of a pixel vary together
    return mean;
}

bool hasDisplay(const MeasuredError::Planes& image, const MeasuredError::Planes& reference) {
    return !image.display.empty() && !reference.display.empty();
}

} // namespace

ErrorFigure MeasuredSquare::root() const {
    const auto rootOf = [](double v) { return std::sqrt(std::max(v, 0.0)); };
    return {rootOf(value), rootOf(value - kNormal95 * standardError), rootOf(value + kNormal95 * standardError), 0, {}};
}

ErrorFigure MeasuredSquare::rootOfDependent() const {
    const double difference = std::sqrt(std::max(value + referenceNoise, 0.0)), own = std::sqrt(referenceNoise);
    return {difference, std::max(difference - own, 0.0), difference + own, 0, {}};
}

MeasuredSquare withoutNoise(const MeasuredSquare& measured, const ErrorFigure& reference) {
    const double noise = reference.value * reference.value;
    const double figure = (reference.high * reference.high - reference.low * reference.low) / (2 * kNormal95);
    const double left = std::max(measured.value - noise, 0.0);
    const double product = 4 * left * noise / static_cast<double>(std::max<std::int64_t>(reference.pixels, 1));
    return {measured.value - noise, std::sqrt(figure * figure + product), noise};
}

MeasuredError MeasuredError::of(const Planes& image, const Planes& a, const Planes& b) {
    ABBE_CHECK(a.luminance.size() == image.luminance.size() && b.luminance.size() == image.luminance.size());
    const RelativeError measure(image.luminance);
    SquareSum sum;
    for (std::size_t i = 0; i < image.luminance.size(); ++i) {
        const double x = image.luminance[i], ta = a.luminance[i], tb = b.luminance[i], t = (ta + tb) / 2;
        sum.add(x - t, square((ta - tb) / 2), measure.relative(1, x, t));
    }
    MeasuredError error{sum.mean(), {}};
    if (hasDisplay(image, a) && hasDisplay(image, b)) error.display = displaySquare(image, a, b);
    return error;
}

MeasuredError MeasuredError::of(const Planes& image, const Planes& reference) {
    ABBE_CHECK(reference.luminance.size() == image.luminance.size());
    ABBE_CHECK(reference.variance.empty() || reference.variance.size() == image.luminance.size());
    const RelativeError measure(image.luminance);
    SquareSum sum;
    for (std::size_t i = 0; i < image.luminance.size(); ++i) {
        const double x = image.luminance[i], t = reference.luminance[i];
        const double v = reference.variance.empty() ? 0 : static_cast<double>(reference.variance[i]);
        if (std::isfinite(v)) sum.add(x - t, v, measure.relative(1, x, t));
    }
    MeasuredError error{sum.mean(), {}};
    if (hasDisplay(image, reference)) error.display = displaySquare(image, reference, reference);
    return error;
}

} // namespace abbe

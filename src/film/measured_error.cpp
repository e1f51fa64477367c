#include "film/measured_error.h"

#include "base/check.h"
#include "film/relative_error.h"

#include <algorithm>

namespace abbe {

namespace {

double code(float v) { return 255 * std::clamp(static_cast<double>(v), 0.0, 1.0); }

} // namespace

MeasuredError MeasuredError::of(const Planes& image, const Planes& a, const Planes& b) {
    ABBE_CHECK(a.luminance.size() == image.luminance.size() && b.luminance.size() == image.luminance.size());
    const RelativeError measure(image.luminance);
    const std::size_t pixels = image.luminance.size();
    MeasuredError error;
    for (std::size_t i = 0; i < pixels; ++i) {
        const double x = image.luminance[i], ta = a.luminance[i], tb = b.luminance[i], t = (ta + tb) / 2;
        error.relative += measure.relative(square(x - t) - square((ta - tb) / 2), x, t);
    }
    error.relative /= static_cast<double>(pixels);
    if (image.display.empty() || a.display.empty() || b.display.empty()) return error;
    double sum = 0;
    for (std::size_t c = 0; c < image.display.size(); ++c)
        sum += (code(image.display[c]) - code(a.display[c])) * (code(image.display[c]) - code(b.display[c]));
    error.display = sum / (3 * static_cast<double>(pixels));
    return error;
}

} // namespace abbe

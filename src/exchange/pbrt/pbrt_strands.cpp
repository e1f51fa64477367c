#include "exchange/pbrt/pbrt_strands.h"

#include <cstring>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

template <typename T> void pbrtAppend(std::string& out, T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    out.append(bytes, sizeof(T));
}

// A quadratic Bézier curve as a cubic one.
std::vector<Vec3> pbrtElevated(const std::vector<Vec3>& q) {
    std::vector<Vec3> out{q[0]};
    for (std::size_t i = 0; i + 2 < q.size(); i += 2) {
        out.push_back(q[i] * (1 / 3.f) + q[i + 1] * (2 / 3.f));
        out.push_back(q[i + 1] * (2 / 3.f) + q[i + 2] * (1 / 3.f));
        out.push_back(q[i + 2]);
    }
    return out;
}

// The knots of a quadratic B-spline are those of Bézier pieces halfway between its points.
std::vector<Vec3> pbrtQuadraticSpline(const std::vector<Vec3>& p) {
    std::vector<Vec3> q;
    for (std::size_t i = 0; i + 1 < p.size(); ++i) {
        q.push_back((p[i] + p[i + 1]) * 0.5f);
        if (i + 2 < p.size()) q.push_back(p[i + 1]);
    }
    return q;
}

} // namespace

std::string PbrtStrands::kind(const PbrtParams& params, Diagnostics& faults) {
    const std::string basis = params.text("basis", "bezier", faults), form = params.text("type", "flat", faults);
    const bool cubicSpline = basis == "bspline" && params.integer("degree", 3, faults) == 3;
    return (cubicSpline ? "bspline " : "bezier ") + form;
}

void PbrtStrands::add(const PbrtParams& params, Diagnostics& faults) {
    const std::string basis = params.text("basis", "bezier", faults);
    const int degree = params.integer("degree", 3, faults);
    std::vector<Vec3> points = params.points("P", faults);
    const auto wrong = [&](std::string_view what) { faults.error("E0802", params.spanOf("P"), std::string(what)); };
    if (degree != 2 && degree != 3) return wrong("the `degree` of a curve is 2 or 3");
    if (basis != "bezier" && basis != "bspline") return wrong("the `basis` of a curve is `bezier` or `bspline`");
    const auto count = points.size(), least = static_cast<std::size_t>(degree) + 1;
    if (count < least || (basis == "bezier" && (count - 1) % static_cast<std::size_t>(degree) != 0))
        return wrong(fmt::format("{} points are no curve of this basis and degree", count));
    for (const Vec3& p : points)
        if (!isFinite(p)) return wrong("a number is too large for single precision");
    if (degree == 2) points = pbrtElevated(basis == "bspline" ? pbrtQuadraticSpline(points) : points);
    const double width = params.number("width", 1, faults);
    const double first = params.number("width0", width, faults), last = params.number("width1", width, faults);
    // Beyond the ends of a cubic B-spline lie a control point each.
    const double outer = basis == "bspline" && degree == 3 ? 1 : 0;
    const double spans = static_cast<double>(points.size()) - 1 - 2 * outer;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double t = (static_cast<double>(i) - outer) / spans;
        radii_.push_back(static_cast<float>(std::max(lerp(first, last, t) / 2, 0.0)));
    }
    points_.insert(points_.end(), points.begin(), points.end());
    sizes_.push_back(static_cast<std::uint32_t>(points.size()));
}

std::string PbrtStrands::takePly() {
    std::string out = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
                                  "property float y\nproperty float z\nproperty float radius\nelement strand {}\n"
                                  "property uint count\nend_header\n",
                                  points_.size(), sizes_.size());
    out.reserve(out.size() + points_.size() * 16 + sizes_.size() * 4);
    for (std::size_t i = 0; i < points_.size(); ++i) {
        pbrtAppend(out, points_[i]);
        pbrtAppend(out, radii_[i]);
    }
    for (const std::uint32_t size : sizes_) pbrtAppend(out, size);
    *this = {};
    return out;
}

} // namespace abbe::exchange

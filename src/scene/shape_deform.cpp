#include "scene/shape_deform.h"

#include <fmt/format.h>

namespace abbe {

namespace {

bool wrongKey(const ShapeKey& key, Diagnostics& diagnostics, std::string message, std::string label) {
    diagnostics.error("E0681", key.span, std::move(message), std::move(label));
    return false;
}

template <typename F>
std::vector<Vec3> combine(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction, F finish) {
    std::vector<Vec3> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        result[i] = Vec3(finish(Vec3d(a[i]) * (1 - fraction) + Vec3d(b[i]) * fraction));
    return result;
}

} // namespace

bool checkKeys(const ShapeParams& params, const std::vector<ShapeKey>& keys, bool hasOwnPoints, bool hasOwnRadius,
               Diagnostics& diagnostics) {
    if (hasOwnPoints)
        return wrongKey(keys[0], diagnostics, "a shape has points of its own, or keys with points",
                        "beside `file` or `points`");
    if (params.emits()) {
        diagnostics.error("E0682", keys[0].span, "a shape that deforms cannot emit light", "it deforms from here on")
            .help = "remove `emission`, or the keys; a `transform` with keys moves without a change of area";
        return false;
    }
    for (const ShapeKey& key : keys) {
        const bool file = !key.file.value.empty(), sized = key.radius || !key.radii.empty();
        if (file != key.points.empty())
            return wrongKey(key, diagnostics, "a key states either `file` or `points`",
                            file ? "states both" : "states neither");
        if (key.radius && !key.radii.empty())
            return wrongKey(key, diagnostics, "a key states either `radius` or `radii`", "states both");
        if (sized && hasOwnRadius)
            return wrongKey(key, diagnostics, "a shape has radii of its own, or keys with radii",
                            "beside `radius` or `radii`");
        if (file == keys[0].file.value.empty())
            return wrongKey(key, diagnostics, "all keys of a shape state the same properties",
                            file ? "`file` here, `points` in the first key" : "`points` here, `file` in the first key");
    }
    return true;
}

KeyGrid gridOf(std::span<const double> times, Interval shutter) { return makeKeyGrid(times, shutter, kMaxTimeSteps); }

std::vector<Vec3> stateOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction) {
    return combine(a, b, fraction, [](Vec3d v) { return v; });
}

std::vector<Vec3> directionsOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction) {
    return combine(a, b, fraction, [](Vec3d v) { return length(v) > 0 ? normalize(v) : v; });
}

std::vector<SizedPoint> stateOf(const std::vector<SizedPoint>& a, const std::vector<SizedPoint>& b, double fraction) {
    std::vector<SizedPoint> result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        result[i] = {Vec3(Vec3d(a[i].position) * (1 - fraction) + Vec3d(b[i].position) * fraction),
                     static_cast<float>(static_cast<double>(a[i].radius) * (1 - fraction) +
                                        static_cast<double>(b[i].radius) * fraction)};
    return result;
}

double offGridDistance(const std::vector<Vec3>& key, const std::vector<Vec3>& instead, const Transform& place) {
    double largest = 0;
    for (std::size_t i = 0; i < key.size(); ++i)
        largest = std::max(largest, length(place.vector(Vec3d(key[i]) - Vec3d(instead[i]))));
    return largest;
}

double offGridDistance(const std::vector<SizedPoint>& key, const std::vector<SizedPoint>& instead,
                       const Transform& place) {
    double largest = 0;
    for (std::size_t i = 0; i < key.size(); ++i)
        largest = std::max(largest, length(place.vector(Vec3d(key[i].position) - Vec3d(instead[i].position))));
    return largest;
}

bool mismatch(Span span, Diagnostics& diagnostics, const std::string& message) {
    diagnostics.error("E0680", span, message, "not the points of the first key");
    return false;
}

void warnOffGrid(double distance, Span span, Diagnostics& diagnostics) {
    if (!(distance > 0)) return;
    diagnostics
        .warning("W0680", span,
                 fmt::format("the keys of this shape lie on no grid of at most {} equal parts of the exposure",
                             kMaxTimeSteps - 1),
                 fmt::format("points are up to {:.2g} m off the place of a key", distance))
        .help = "keys at equal fractions of the exposure are exact";
}

} // namespace abbe

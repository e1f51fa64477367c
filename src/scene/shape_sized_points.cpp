#include "scene/shape_sized_points.h"

#include "scene/file_faults.h"

#include <fmt/format.h>

namespace abbe {

namespace {

std::optional<PointFile> readFile(const schema::Text& file, Span span, Diagnostics& diagnostics) {
    std::optional<PointFile> points;
    readsFile(file.value, file.span.valid() ? file.span : span, diagnostics,
              [&] { points = readPlyPoints(file.value); });
    return points;
}

// The radius of every point, or nothing after an error.
std::optional<std::vector<float>> radiiOf(const SizedPointsParams& p, const PointFile& file, double unit,
                                          std::size_t count, Span span, Diagnostics& diagnostics) {
    if (p.radius) return std::vector<float>(count, static_cast<float>(*p.radius));
    if (!p.radii.empty()) {
        if (p.radii.size() == count) return std::vector<float>(p.radii.begin(), p.radii.end());
        diagnostics.error("E0621", span, fmt::format("{} radii for {} points", p.radii.size(), count), "do not match");
        return std::nullopt;
    }
    if (file.radii.empty()) {
        diagnostics.error("E0621", span, "nothing says how thick it is", "no radius").help =
            "add `radius`, `radii` with one value per point, or a property `radius` to the file";
        return std::nullopt;
    }
    std::vector<float> radii = file.radii;
    for (float& r : radii) r = static_cast<float>(static_cast<double>(r) * unit);
    return radii;
}

} // namespace

std::optional<std::pair<std::vector<SizedPoint>, PointFile>> loadSizedPoints(const SizedPointsParams& p, double unit,
                                                                             Span span, Diagnostics& diagnostics) {
    PointFile file;
    if (p.file.value.empty()) {
        for (const Vec3d point : p.points) file.positions.push_back(Vec3(point));
    } else {
        auto read = readFile(p.file, span, diagnostics);
        if (!read) return std::nullopt;
        file = std::move(*read);
        for (Vec3& point : file.positions) point = Vec3(Vec3d(point) * unit);
    }
    if (file.positions.empty()) {
        diagnostics.error("E0604", span, "there are no points", "nothing to see here").help =
            "write `points { … }`, or name a PLY file";
        return std::nullopt;
    }
    const auto radii = radiiOf(p, file, unit, file.positions.size(), span, diagnostics);
    if (!radii) return std::nullopt;
    std::vector<SizedPoint> points(file.positions.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = {file.positions[i], (*radii)[i]};
    return std::pair(std::move(points), std::move(file));
}

bool placeSizedPoints(std::vector<SizedPoint>& points, const Transform& place, Span span, Diagnostics& diagnostics) {
    const auto scale = place.uniformScale();
    if (!scale) {
        diagnostics.error("E0622", span, "curves and points cannot be stretched unevenly in place", "scaled unevenly")
            .help = "put the shape into an `object` and the transform into an `instance` of it";
        return false;
    }
    for (SizedPoint& p : points) {
        const Vec3d moved = place.point(Vec3d(p.position));
        const double radius = *scale * static_cast<double>(p.radius);
        if (!isFinite(moved) || !(maxComponent(abs(moved)) + radius < kLargestCoordinate)) {
            diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
            return false;
        }
        p = {Vec3(moved), static_cast<float>(radius)};
    }
    return true;
}

} // namespace abbe

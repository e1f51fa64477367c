// Curves and points with keys.
#include "scene/shape_builder.h"
#include "scene/shape_deform.h"

#include <fmt/format.h>

namespace abbe {

namespace {

template <typename Params> Params withKey(const Params& params, const ShapeKey& key) {
    Params here = params;
    here.keys.clear();
    here.file = key.file;
    here.points = key.points;
    if (key.radius) here.radius = key.radius;
    if (!key.radii.empty()) here.radii = key.radii;
    return here;
}

bool ownPoints(const SizedPointsParams& p) { return !p.file.value.empty() || !p.points.empty(); }
bool ownRadius(const SizedPointsParams& p) { return p.radius || !p.radii.empty(); }

const auto kPointsOf = [](const auto& data) -> const std::vector<SizedPoint>& { return data.points; };

// The points of all steps; a warning if they are not exactly the keys.
template <typename T>
std::vector<std::vector<SizedPoint>> stepsOf(const Keys<T>& keys, const KeyGrid& grid, const Transform& place,
                                             Span span, Diagnostics& diagnostics) {
    std::vector<std::vector<SizedPoint>> steps;
    for (const KeyPosition p : grid.steps) steps.push_back(stateAt(keys, p, kPointsOf));
    warnOffGrid(
        grid, [&](std::size_t i) -> const auto& { return keys.states[i].points; },
        [&](std::size_t i) -> const auto& { return steps[i]; }, place, span, diagnostics);
    return steps;
}

} // namespace

std::optional<CurveKeys> loadCurveKeys(const CurvesParams& params, double unit, Diagnostics& diagnostics) {
    CurveKeys keys;
    for (const ShapeKey& key : params.keys) {
        auto data = loadCurveData(withKey(params, key), unit, key.span, diagnostics);
        if (!data) return std::nullopt;
        if (!keys.states.empty() && data->strandSizes != keys.states[0].strandSizes) {
            const CurveData& first = keys.states[0];
            mismatch(key.span, diagnostics,
                     data->points.size() == first.points.size() && data->strandSizes.size() == first.strandSizes.size()
                         ? std::string("strands have other numbers of points than in the first key")
                         : fmt::format("{} points in {} strands, but {} in {} in the first key", data->points.size(),
                                       data->strandSizes.size(), first.points.size(), first.strandSizes.size()));
            return std::nullopt;
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(*data));
    }
    return keys;
}

std::optional<PointKeys> loadPointKeys(const PointsParams& params, double unit, Diagnostics& diagnostics) {
    PointKeys keys;
    for (const ShapeKey& key : params.keys) {
        PointsParams here = withKey(params, key);
        if (!key.normals.empty()) here.normals = key.normals;
        auto data = loadPointData(here, unit, key.span, diagnostics);
        if (!data) return std::nullopt;
        if (!keys.states.empty() && data->points.size() != keys.states[0].points.size()) {
            mismatch(
                key.span, diagnostics,
                fmt::format("{} points, but {} in the first key", data->points.size(), keys.states[0].points.size()));
            return std::nullopt;
        }
        if (!keys.states.empty() && data->form != keys.states[0].form) {
            mismatch(key.span, diagnostics, "disks have normals in all keys or in none");
            return std::nullopt;
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(*data));
    }
    return keys;
}

std::unique_ptr<const Shape> placeCurveKeys(const CurveKeys& keys, Interval shutter, const Transform& place, Span span,
                                            Diagnostics& diagnostics) {
    auto steps = stepsOf(keys, gridOf(keys.times, shutter), place, span, diagnostics);
    const CurveData& first = keys.states[0];
    CurveData data{first.basis, first.form, std::move(steps[0]), first.strandSizes};
    data.later.assign(std::make_move_iterator(steps.begin() + 1), std::make_move_iterator(steps.end()));
    return placeCurves(std::move(data), place, span, diagnostics);
}

std::unique_ptr<const Shape> placePointKeys(const PointKeys& keys, Interval shutter, const Transform& place, Span span,
                                            Diagnostics& diagnostics) {
    const KeyGrid grid = gridOf(keys.times, shutter);
    auto steps = stepsOf(keys, grid, place, span, diagnostics);
    PointData data;
    data.form = keys.states[0].form;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        PointData::Step step{std::move(steps[i]),
                             directionsAt(
                                 keys, grid.steps[i], [](const PointData& p) -> const auto& { return p.normals; })};
        if (i > 0) {
            data.later.push_back(std::move(step));
            continue;
        }
        data.points = std::move(step.points);
        data.normals = std::move(step.normals);
    }
    return placePoints(std::move(data), place, span, diagnostics);
}

void deformCurves(const CurvesParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    if (!checkKeys(params, params.keys, ownPoints(params), ownRadius(params), context.diagnostics)) return;
    auto keys = loadCurveKeys(params, context.unit, context.diagnostics);
    if (!keys) return;
    builder.noteFiles(params.keys);
    const CurveData& first = keys->states[0];
    for (const std::uint32_t size : first.strandSizes)
        shape.segments += (size - leastPoints(first.basis)) / pointStep(first.basis) + 1;
    shape.strands = first.strandSizes.size();
    shape.sound = true;
    shape.deforms = builder.motion.deforms(keys->times);
    shape.place = [kept = std::make_shared<const CurveKeys>(std::move(*keys)), context](const Transform& place) {
        return placeCurveKeys(*kept, context.shutter, place, context.span, context.diagnostics);
    };
}

void deformPoints(const PointsParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    if (!checkKeys(params, params.keys, ownPoints(params), ownRadius(params), context.diagnostics)) return;
    auto keys = loadPointKeys(params, context.unit, context.diagnostics);
    if (!keys) return;
    builder.noteFiles(params.keys);
    shape.points = keys->states[0].points.size();
    shape.sound = true;
    shape.deforms = builder.motion.deforms(keys->times);
    shape.place = [kept = std::make_shared<const PointKeys>(std::move(*keys)), context](const Transform& place) {
        return placePointKeys(*kept, context.shutter, place, context.span, context.diagnostics);
    };
}

} // namespace abbe

#include "scene/shape_points.h"

#include "scene/file_faults.h"
#include "scene/shape_builder.h"

#include <algorithm>
#include <cmath>
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

namespace {

constexpr std::array<std::pair<std::string_view, CurveBasis>, 4> kBases{{{"linear", CurveBasis::linear},
                                                                         {"bspline", CurveBasis::bspline},
                                                                         {"catmull-rom", CurveBasis::catmullRom},
                                                                         {"bezier", CurveBasis::bezier}}};

// Points of each strand as whole numbers; nothing after an error.
std::optional<std::vector<std::uint32_t>> sizesOf(const std::vector<double>& counts, std::size_t points, Span span,
                                                  Diagnostics& diagnostics) {
    std::vector<std::uint32_t> sizes;
    double sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] != std::floor(counts[i]) || counts[i] > static_cast<double>(points)) {
            diagnostics.error("E0621", span, fmt::format("strand {} of {} points", i, counts[i]),
                              counts[i] != std::floor(counts[i]) ? "not a whole number" : "more than there are");
            return std::nullopt;
        }
        sizes.push_back(static_cast<std::uint32_t>(counts[i]));
        sum += counts[i];
    }
    if (sum != static_cast<double>(points)) {
        diagnostics.error("E0621", span, fmt::format("the strands have {} points, but there are {}", sum, points),
                          "`counts` do not match");
        return std::nullopt;
    }
    return sizes;
}

bool checkSizes(const CurveData& data, std::string_view basis, Span span, Diagnostics& diagnostics) {
    const std::uint32_t least = leastPoints(data.basis), step = pointStep(data.basis);
    for (std::size_t i = 0; i < data.strandSizes.size(); ++i) {
        const std::uint32_t size = data.strandSizes[i];
        if (size >= least && (size - least) % step == 0) continue;
        const std::string rule =
            step == 1 ? fmt::format("{} needs at least {}", basis, least) : fmt::format("{} needs 4, 7, 10, …", basis);
        diagnostics.error("E0621", span, fmt::format("strand {} has {} points; {}", i, size, rule), "wrong number");
        return false;
    }
    return true;
}

} // namespace

schema::TypeInfo curvesType() {
    using namespace schema;
    using P = CurvesParams;
    std::vector<FieldInfo> fields = {
        field<P, Choice>(FieldType::choice, "basis", &P::basis)
            .choices({"linear", "bspline", "catmull-rom", "bezier"})
            .byDefault("bspline")
            .synonyms({"type", "curve"})
            .doc("How the points make a curve. Each B-spline and Catmull-Rom segment takes four points in a row.")
            .example("basis catmull-rom"),
        field<P, Choice>(FieldType::choice, "form", &P::form)
            .choices({"round", "flat"})
            .byDefault("round")
            .synonyms({"mode", "style"})
            .doc("Round tubes, or flat ribbons that face each ray: cheaper, for hair thinner than a pixel.")
            .example("form flat"),
        field<P, std::vector<double>>(FieldType::numbers, "counts", &P::counts)
            .range(1, 4294967294.0)
            .synonyms({"strands", "vertex-counts", "nvertices"})
            .doc("How many of the points belong to each strand, in order; one strand of all points when absent.")
            .example("counts 4 4 6"),
    };
    addSizedPointFields<P>(fields);
    fields.push_back(keysField<P>(curvesKeyFields()));
    addShapeFields<P>(fields);
    return {Kind::shape,
            "curves",
            "Hair, fur, grass, wire: thin curves with a width.",
            "shape curves { radius 0.1; points { - 0 0 0; - 0 1 0; - 0 2 1; - 0 2 2 } }",
            false,
            std::move(fields)};
}

std::optional<CurveData> loadCurveData(const CurvesParams& p, double unit, Span span, Diagnostics& diagnostics) {
    auto loaded = loadSizedPoints(p, unit, span, diagnostics);
    if (!loaded) return std::nullopt;
    auto& [points, file] = *loaded;
    CurveData data;
    for (const auto& [word, basis] : kBases)
        if (word == p.basis.word) data.basis = basis;
    data.form = p.form.word == "flat" ? CurveForm::flat : CurveForm::round;
    if (!p.counts.empty()) {
        auto sizes = sizesOf(p.counts, points.size(), span, diagnostics);
        if (!sizes) return std::nullopt;
        data.strandSizes = std::move(*sizes);
    } else if (!file.strandSizes.empty()) {
        data.strandSizes = std::move(file.strandSizes);
    } else {
        data.strandSizes = {static_cast<std::uint32_t>(points.size())};
    }
    if (file.strandPoints.empty() || !p.counts.empty()) {
        data.points = std::move(points);
    } else {
        data.points.reserve(file.strandPoints.size());
        for (const std::uint32_t i : file.strandPoints) data.points.push_back(points[i]);
    }
    if (!checkSizes(data, p.basis.word, span, diagnostics)) return std::nullopt;
    return data;
}

std::unique_ptr<const Shape> placeCurves(CurveData data, const Transform& place, Span span, Diagnostics& diagnostics) {
    if (!placeSizedPoints(data.points, place, span, diagnostics)) return nullptr;
    for (auto& step : data.later)
        if (!placeSizedPoints(step, place, span, diagnostics)) return nullptr;
    auto curves = std::make_unique<const Curves>(std::move(data));
    if (curves->segmentCount() == 0) {
        diagnostics.error("E0604", span, "these curves have no width or no length", "nothing to see here");
        return nullptr;
    }
    if (curves->omittedSegments() > 0)
        diagnostics.warning("W0621", span,
                            fmt::format("{} of {} segments have no width or no length and are left out",
                                        curves->omittedSegments(), curves->segmentCount() + curves->omittedSegments()));
    return curves;
}

bool refuseEmission(const schema::Definition& d, const ShapeParams& params, Diagnostics& diagnostics) {
    if (!params.emits()) return false;
    Span span = d.span;
    for (const schema::Node& property : d.properties)
        if (property.name() == "emission") span = property.nameSpan();
    diagnostics.error("E0623", span, "curves and points cannot emit light in this version", "not supported").help =
        "this is planned; small `sphere` shapes can emit";
    return true;
}

void loadCurves(const CurvesParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    shape.openBecause = "curves are open at their ends";
    if (refuseEmission(*shape.definition, params, context.diagnostics)) return;
    if (!params.keys.empty()) return deformCurves(params, builder, shape);
    const auto data = builder.data<CurveData>(shape, [&]() -> std::shared_ptr<const CurveData> {
        auto made = loadCurveData(params, context.unit, context.span, context.diagnostics);
        return made ? std::make_shared<const CurveData>(std::move(*made)) : nullptr;
    });
    if (!data) return;
    if (!params.file.value.empty()) builder.scene.noteFile(params.file.value);
    for (const std::uint32_t size : data->strandSizes)
        shape.segments += (size - leastPoints(data->basis)) / pointStep(data->basis) + 1;
    shape.strands = data->strandSizes.size();
    shape.sound = true;
    shape.place = [data, context](const Transform& place) {
        return placeCurves(*data, place, context.span, context.diagnostics);
    };
}

schema::TypeInfo pointsType() {
    using namespace schema;
    using P = PointsParams;
    std::vector<FieldInfo> fields = {
        field<P, Choice>(FieldType::choice, "form", &P::form)
            .choices({"sphere", "disk"})
            .byDefault("sphere")
            .synonyms({"mode", "style"})
            .doc("Spheres, or flat disks: across `normals` where there are some, else facing each ray.")
            .example("form disk"),
        field<P, std::vector<Vec3d>>(FieldType::points, "normals", &P::normals)
            .unit({Dimension::none})
            .synonyms({"N", "orientations"})
            .doc("Direction of the outer side of each disk, of any length.")
            .example("normals { - 0 1 0; - 0 1 0.5 }"),
    };
    addSizedPointFields<P>(fields);
    fields.push_back(keysField<P>(pointsKeyFields()));
    addShapeFields<P>(fields);
    return {Kind::shape,
            "points",
            "Many small spheres or disks: spray, dust, particles.",
            "shape points { radius 0.1; points { - 0 0 0; - 0 1 0 } }",
            false,
            std::move(fields)};
}

std::optional<PointData> loadPointData(const PointsParams& p, double unit, Span span, Diagnostics& diagnostics) {
    auto loaded = loadSizedPoints(p, unit, span, diagnostics);
    if (!loaded) return std::nullopt;
    PointData data;
    data.points = std::move(loaded->first);
    if (p.form.word != "disk") {
        if (p.normals.empty()) return data;
        diagnostics.error("E0621", span, "spheres have no `normals`", "form sphere").help = "write `form disk`";
        return std::nullopt;
    }
    std::vector<Vec3> normals = std::move(loaded->second.normals);
    if (!p.normals.empty()) {
        normals.clear();
        for (const Vec3d n : p.normals) normals.push_back(Vec3(n));
    }
    if (normals.empty()) {
        data.form = PointForm::disk;
        return data;
    }
    if (normals.size() != data.points.size()) {
        diagnostics.error("E0621", span, fmt::format("{} normals for {} points", normals.size(), data.points.size()),
                          "do not match");
        return std::nullopt;
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Vec3d n(normals[i]);
        if (!(length(n) > 0)) {
            diagnostics.error("E0621", span, fmt::format("the normal of point {} is 0", i), "no direction");
            return std::nullopt;
        }
        normals[i] = Vec3(normalize(n));
    }
    data.form = PointForm::orientedDisk;
    data.normals = std::move(normals);
    return data;
}

std::unique_ptr<const Shape> placePoints(PointData data, const Transform& place, Span span, Diagnostics& diagnostics) {
    if (!placeSizedPoints(data.points, place, span, diagnostics)) return nullptr;
    const auto turn = [&place](Vec3& n) { n = Vec3(normalize(place.normal(Vec3d(n)))); };
    std::ranges::for_each(data.normals, turn);
    for (PointData::Step& step : data.later) {
        if (!placeSizedPoints(step.points, place, span, diagnostics)) return nullptr;
        std::ranges::for_each(step.normals, turn);
    }
    auto points = std::make_unique<const Points>(std::move(data));
    if (points->count() == 0) {
        diagnostics.error("E0604", span, "these points have no width", "nothing to see here");
        return nullptr;
    }
    if (points->omitted() > 0)
        diagnostics.warning("W0621", span,
                            fmt::format("{} of {} points have no width and are left out", points->omitted(),
                                        points->count() + points->omitted()));
    return points;
}

void loadPoints(const PointsParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    if (params.form.word != "sphere") shape.openBecause = "disks have no inside";
    if (refuseEmission(*shape.definition, params, context.diagnostics)) return;
    if (!params.keys.empty()) return deformPoints(params, builder, shape);
    const auto data = builder.data<PointData>(shape, [&]() -> std::shared_ptr<const PointData> {
        auto made = loadPointData(params, context.unit, context.span, context.diagnostics);
        return made ? std::make_shared<const PointData>(std::move(*made)) : nullptr;
    });
    if (!data) return;
    if (!params.file.value.empty()) builder.scene.noteFile(params.file.value);
    shape.points = data->points.size();
    shape.sound = true;
    shape.place = [data, context](const Transform& place) {
        return placePoints(*data, place, context.span, context.diagnostics);
    };
}

} // namespace abbe

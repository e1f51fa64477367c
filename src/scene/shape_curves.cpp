#include "scene/shape_curves.h"

#include "scene/shape_builder.h"
#include "scene/shape_sized_points.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

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
    auto data = loadCurveData(params, context.unit, context.span, context.diagnostics);
    if (!data) return;
    if (!params.file.value.empty()) builder.scene.noteFile(params.file.value);
    for (const std::uint32_t size : data->strandSizes)
        shape.segments += (size - leastPoints(data->basis)) / pointStep(data->basis) + 1;
    shape.strands = data->strandSizes.size();
    shape.sound = true;
    shape.place = [kept = std::make_shared<const CurveData>(std::move(*data)), context](const Transform& place) {
        return placeCurves(*kept, place, context.span, context.diagnostics);
    };
}

} // namespace abbe

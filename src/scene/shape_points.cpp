#include "scene/shape_builder.h"
#include "scene/shape_curves.h"
#include "scene/shape_sized_points.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

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
    auto data = loadPointData(params, context.unit, context.span, context.diagnostics);
    if (!data) return;
    if (!params.file.value.empty()) builder.scene.noteFile(params.file.value);
    shape.points = data->points.size();
    shape.sound = true;
    shape.place = [kept = std::make_shared<const PointData>(std::move(*data)), context](const Transform& place) {
        return placePoints(*kept, place, context.span, context.diagnostics);
    };
}

} // namespace abbe

// Curves and points as the language states them.
#pragma once

#include "geometry/curves.h"
#include "geometry/points.h"
#include "io/ply_points.h"
#include "scene/shape_mesh.h"
#include "schema/scene_tree.h"

namespace abbe {

// Positions and widths, which both have.
struct SizedPointsParams : ShapeParams {
    schema::Text file;         // resolved path, or empty
    std::vector<Vec3d> points; // if there is no file
    std::optional<double> radius;
    std::vector<double> radii;  // one per point
    std::vector<ShapeKey> keys; // instead of file and points: it deforms
};
struct CurvesParams : SizedPointsParams {
    schema::Choice basis{"bspline", {}};
    schema::Choice form{"round", {}};
    std::vector<double> counts; // points of each strand; empty: one strand, or those of the file
};
struct PointsParams : SizedPointsParams {
    schema::Choice form{"sphere", {}};
    std::vector<Vec3d> normals; // one per point; empty: those of the file, or disks that turn to the ray
};

schema::TypeInfo curvesType();
schema::TypeInfo pointsType();

// In the shape's own space; lengths of files times `unit`. Nothing after an error located at `span`.
std::optional<CurveData> loadCurveData(const CurvesParams&, double unit, Span, Diagnostics&);
std::optional<PointData> loadPointData(const PointsParams&, double unit, Span, Diagnostics&);

// Null after an error: what is round does not stay so under a map that stretches unevenly.
std::unique_ptr<const Shape> placeCurves(CurveData, const Transform& place, Span, Diagnostics&);
std::unique_ptr<const Shape> placePoints(PointData, const Transform& place, Span, Diagnostics&);

// What curves and points share: positions and widths, from the scene or from a file.

// The points that the parameters name, each with its radius, and the rest of the file. The errors are located.
std::optional<std::pair<std::vector<SizedPoint>, PointFile>> loadSizedPoints(const SizedPointsParams&, double unit,
                                                                             Span, Diagnostics&);
// Moves the points, scales the radii. False after an error.
bool placeSizedPoints(std::vector<SizedPoint>&, const Transform& place, Span, Diagnostics&);

// Whether the definition asks for light, which these shapes cannot give: an error.
bool refuseEmission(const schema::Definition&, const ShapeParams&, Diagnostics&);

template <typename P> void addSizedPointFields(std::vector<schema::FieldInfo>& fields) {
    using namespace schema;
    fields.push_back(field<P, Text>(FieldType::file, "file", &P::file)
                         .argument(0)
                         .group("source")
                         .synonyms({"filename", "path"})
                         .doc("PLY file, binary or text, with `radius` (or `width`) at its vertices.")
                         .example("file \"fur.ply\""));
    fields.push_back(field<P, std::vector<Vec3d>>(FieldType::points, "points", &P::points)
                         .unit({Dimension::length})
                         .group("source")
                         .synonyms({"vertices", "P", "positions"})
                         .doc("Positions, one row of three numbers each, or one long list.")
                         .example("points { - 0 0 0; - 0 1 0; - 0 2 1; - 0 2 2 }"));
    fields.push_back(field<P, std::optional<double>>(FieldType::quantity, "radius", &P::radius)
                         .unit({Dimension::length})
                         .range(0, 1e15)
                         .group("thickness")
                         .synonyms({"width", "thickness", "size"})
                         .doc("Radius everywhere, also instead of a file's.")
                         .example("radius 0.05 mm"));
    fields.push_back(field<P, std::vector<double>>(FieldType::numbers, "radii", &P::radii)
                         .unit({Dimension::length})
                         .range(0, 1e15)
                         .group("thickness")
                         .synonyms({"widths"})
                         .doc("Radius at each point.")
                         .example("radii 2 2 1 0 mm"));
}

} // namespace abbe

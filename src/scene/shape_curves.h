// Curves and points as the language states them.
#pragma once

#include "geometry/curves.h"
#include "geometry/points.h"
#include "scene/shape_mesh.h"

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

} // namespace abbe

// Boxes, cylinders, cones and tori as the language states them.
#pragma once

#include "scene/shape_types.h"

namespace abbe {

// About its centre: axis upwards when unset.
struct BoxParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> size; // unset, and no corners: 1 1 1
    std::optional<Vec3d> min, max;
};
struct CylinderParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> axis;
    double radius = 0.5, height = 1;
    bool caps = true;
};
struct ConeParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> axis;
    double radius = 0.5, topRadius = 0, height = 1;
    bool caps = true;
};
struct TorusParams : ShapeParams {
    Vec3d center;
    std::optional<Vec3d> axis;
    double majorRadius = 0.5, minorRadius = 0.125;
};

std::vector<schema::TypeInfo> parametricTypes();

} // namespace abbe

// The area lights of the language: the amount, and the geometry of which the scene builder makes a Shape. Lengths in m,
// in the space of the light's parent after `transform`. The outer side emits: where the normal points.
#pragma once

#include "lights/amount.h"
#include "math/motion.h"
#include "render/visible_field.h"

#include <vector>

namespace abbe {

struct AreaLightParams : AmountParams, VisibleParams {
    bool twoSided = false;
    schema::Reference texture; // factor of the radiance; unset: 1
    KeyedTransform transform;  // light to parent
};

// A rectangle of `size` in the xy-plane about the origin, facing +z, or four corners, counter-clockwise seen from
// the emitting side.
struct LightQuadParams : AreaLightParams {
    std::vector<Vec3d> points; // four, or empty
    Vec2d size{1, 1};
};

struct LightDiskParams : AreaLightParams {
    Vec3d center;
    Vec3d normal{0, 0, 1};
    double radius = 0.5;
};

struct LightSphereParams : AreaLightParams {
    Vec3d center;
    double radius = 0.5;
};

struct LightMeshParams : AreaLightParams {
    schema::Text file; // empty: points and faces
    std::vector<Vec3d> points;
    schema::IndexRows faces;
};

schema::TypeInfo lightQuadType();
schema::TypeInfo lightDiskType();
schema::TypeInfo lightSphereType();
schema::TypeInfo lightMeshType();

// The types of light without area are beside their classes: point_light.h, spot_light.h, sun_light.h, sky_light.h,
// environment_light.h.

} // namespace abbe

// Clouds and smoke from voxels.
#pragma once

#include "math/transform.h"
#include "media/medium_optics.h"
#include "render/medium.h"
#include "volumes/brick_bounds.h"

namespace abbe {

// Density is that of the grid times a factor, trilinear between voxels. Owns grid and bounds.
class GridMedium final : public Medium {
  public:
    // `worldToRender` places the grid's own world. Requires an invertible transform and factor >= 0.
    GridMedium(MediumOptics, VoxelGrid, double factor, const Transform& worldToRender);

    Bounds3 bounds() const override { return bounds_; }
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;
    const Curve& extinction() const override { return *optics_.extinction; }
    const Curve& albedo() const override { return *optics_.albedo; }
    const PhaseFunction& phase() const override { return *optics_.phase; }

  private:
    MediumOptics optics_;
    VoxelGrid grid_;
    BrickBounds bricks_;
    Transform toIndex_; // render space to index space
    Bounds3 bounds_;
    float factor_, thickest_; // `thickest_`: greatest extinction at density 1 of the grid, 1/m
};

// `volume vdb`: grids from a file.
struct VdbParams : MediumParams {
    schema::Text file; // resolved path
    schema::Text grid; // "density" when empty
    double scale = 1;
    bool levelSet = false; // a level set is made into fog
    Transform transform;
};
schema::TypeInfo vdbType();

} // namespace abbe

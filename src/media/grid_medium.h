// Clouds, smoke and fire from voxels.
#pragma once

#include "math/transform.h"
#include "media/glow.h"
#include "media/grid_emission.h"
#include "media/medium_optics.h"
#include "render/kept_tables.h"

namespace abbe {

// `volume vdb`: grids from a file.
struct VdbParams : MediumParams, GlowParams {
    schema::Text file;                   // resolved path
    std::optional<schema::Text> density; // names of grids; empty: the usual one
    std::optional<schema::Text> temperature, flame, color, velocity;
    std::optional<double> time; // s, of the file's fields; when the shutter opens if absent
    bool levelSet = false;      // a level set is made into fog
    Transform transform;
};

schema::TypeInfo vdbType();

// value = offset + scale · grid.
struct ScaledGrid {
    VoxelGrid grid;
    double scale = 1, offset = 0;
};

// What a volume may have besides its density. Grids are in the world of the density's.
struct GridExtras {
    struct Color {
        VectorGrid grid;
        std::unique_ptr<const UpsamplingTable> table;
    };
    std::optional<Color> color;                   // factor of the albedo
    std::optional<GridVelocity> velocity;         // carries all other grids along
    std::optional<Glow> glow;                     // emits, by ...
    std::optional<ScaledGrid> flame, temperature; // ... the first as its amount, else the density; 1/m or so and K
};

// A medium with the density of a grid. Density is that of the grid times a factor, trilinear between voxels. Owns its
// grids and their bounds.
class GridMedium final : public OpticalMedium {
  public:
    // `worldToRender` places the grids' own world. Requires an invertible transform, factor >= 0, and a temperature
    // if the glow is thermal.
    // `grids` stands for density and velocity where their bounds are kept.
    GridMedium(MediumOptics, VoxelGrid, double factor, const Transform& worldToRender, GridExtras extras = {},
               KeptTables* kept = nullptr, const Digest& grids = {});
    GridMedium(const GridMedium&) = delete;
    GridMedium& operator=(const GridMedium&) = delete;

    Bounds3 bounds() const override { return bounds_; }
    MediumWalk* walk(const Ray&, float tMax, WalkSpace&) const noexcept override;
    bool albedoVaries() const override { return color_.has_value(); }
    const MediumEmission* emission() const override { return emission_.get(); }
    const GridEmission* gridEmission() const { return emission_.get(); } // null: nothing emits

    // How far in voxels of the density anything moves while the shutter is open, along any axis.
    double drift() const { return motion_ ? driftInVoxels(*motion_, density_) : 0; }

  private:
    void makeEmission(const Glow&, const GridExtras&);

    GridField<float> density_;
    std::optional<GridColor> color_;
    std::optional<GridMotion> motion_; // only if something moves
    std::optional<GridField<float>> flame_, temperature_;
    std::shared_ptr<const BrickBounds> bricks_; // wherever things are while the shutter is open
    double perVoxel_ = 1;                       // units of their space
    Bounds3 bounds_;
    float factor_, thickest_; // `thickest_`: greatest extinction at density 1 of the grid, 1/m
    std::unique_ptr<const GridEmission> emission_;
};

} // namespace abbe

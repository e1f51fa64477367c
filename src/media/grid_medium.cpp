#include "media/grid_medium.h"

#include "base/check.h"
#include "volumes/brick_walk.h"

namespace abbe {

namespace {

class GridWalk final : public MediumWalk {
  public:
    GridWalk(const VoxelGrid& grid, const BrickBounds& bricks, Vec3d origin, Vec3d direction, float tMax, float factor,
             float thickest)
        : walk_(bricks, origin, direction, 0, tMax, thickest), sampler_(grid.sampler()), origin_(origin),
          direction_(direction), factor_(factor) {}

    bool next(MediumSegment& s) noexcept override {
        BrickSegment brick;
        if (!walk_.next(brick)) return false;
        s = {brick.tNear, brick.tFar, brick.minimum * factor_, brick.mean * factor_, brick.maximum * factor_};
        return true;
    }
    float density(float t) noexcept override {
        // In double: far from the grid's origin a place in float would miss its brick's bounds.
        return sampler_.at(Vec3(origin_ + direction_ * static_cast<double>(t))) * factor_;
    }

  private:
    BrickWalk walk_;
    VoxelGrid::Sampler sampler_;
    Vec3d origin_, direction_; // index space
    float factor_;
};

} // namespace

GridMedium::GridMedium(MediumOptics optics, VoxelGrid grid, double factor, const Transform& worldToRender)
    : optics_(std::move(optics)), grid_(std::move(grid)), bricks_(BrickBounds::build(grid_)),
      factor_(static_cast<float>(factor)) {
    const Transform toRender = grid_.indexToWorld().then(worldToRender);
    const auto inverse = toRender.inverse();
    ABBE_CHECK(inverse.has_value());
    toIndex_ = *inverse;
    thickest_ = factor_ * static_cast<float>(optics_.extinction->maximum());
    const Bounds3 box = grid_.support();
    if (grid_.empty()) return;
    for (int corner = 0; corner < 8; ++corner)
        bounds_.add(Vec3(toRender.point({static_cast<double>(corner & 1 ? box.upper.x : box.lower.x),
                                         static_cast<double>(corner & 2 ? box.upper.y : box.lower.y),
                                         static_cast<double>(corner & 4 ? box.upper.z : box.lower.z)})));
}

MediumWalk* GridMedium::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    return space.make<GridWalk>(grid_, bricks_, toIndex_.point(Vec3d(ray.origin)),
                                toIndex_.vector(Vec3d(ray.direction)), tMax, factor_, thickest_);
}

schema::TypeInfo vdbType() {
    using namespace schema;
    using P = VdbParams;
    std::vector<FieldInfo> fields = {
        field<P, Text>(FieldType::file, "file", &P::file)
            .argument(0)
            .required()
            .synonyms({"filename", "path"})
            .doc("OpenVDB file.")
            .example("file \"cloud.vdb\""),
        field<P, Text>(FieldType::text, "grid", &P::grid)
            .synonyms({"density", "grid_name", "field"})
            .doc("Name of the grid that is the density; \"density\" when absent.")
            .example("grid \"smoke\""),
        field<P, double>(FieldType::number, "scale", &P::scale)
            .range(0, 1e12)
            .byDefault("1")
            .synonyms({"density_scale", "multiplier"})
            .doc("Factor of the density.")
            .example("scale 2.5"),
        field<P, bool>(FieldType::toggle, "level-set", &P::levelSet)
            .byDefault("off")
            .doc("Whether a level set may be used: it becomes fog of density 1 with a soft edge.")
            .example("level-set on"),
    };
    addOpticsFields<P>(fields);
    fields.push_back(field<P, Transform>(FieldType::transform, "transform", &P::transform)
                         .synonyms({"to_world", "toWorld", "xform"})
                         .doc("Places the volume: steps from top to bottom, as applied to the object.")
                         .example("transform { scale 2; translate 0 1 0 }"));
    return {Kind::volume,
            "vdb",
            "Density from an OpenVDB grid: cloud, smoke.",
            "volume cloud vdb \"cloud.vdb\" { extinction 0.08 per-m; phase henyey-greenstein 0.85 }",
            false,
            std::move(fields)};
}

} // namespace abbe

#include "media/grid_medium.h"

#include "volumes/brick_walk.h"

namespace abbe {

namespace {

// Along a line; what the medium has besides its density is there if it is given.
struct GridParts {
    const GridField<float>& density;
    const BrickBounds& bricks;
    const GridColor* color;
    const GridMotion* motion;
    const Curve& albedo;
    float factor, thickest;
};

class GridWalk final : public MediumWalk {
  public:
    GridWalk(const GridParts& parts, const Ray& ray, float tMax)
        : density_(parts.density, Vec3d(ray.origin), Vec3d(ray.direction)),
          walk_(parts.bricks, density_.origin(), density_.direction(), 0, tMax, parts.thickest),
          color_(parts.color, Vec3d(ray.origin), Vec3d(ray.direction)),
          motion_(parts.motion, Vec3d(ray.origin), Vec3d(ray.direction), ray.time), albedo_(&parts.albedo),
          factor_(parts.factor) {}

    bool next(MediumSegment& s) noexcept override {
        BrickSegment brick;
        if (!walk_.next(brick)) return false;
        s = {brick.tNear, brick.tFar, brick.minimum * factor_, brick.mean * factor_, brick.maximum * factor_};
        return true;
    }
    float density(float t) noexcept override {
        return (motion_.moves() ? density_.at(t, motion_.shift(t)) : density_.at(t)) * factor_;
    }
    Spectrum albedo(float t, const Wavelengths& lambda) noexcept override {
        return albedo_->at(lambda) * (motion_.moves() ? color_.at(t, motion_.shift(t), lambda) : color_.at(t, lambda));
    }

  private:
    FieldAlong<float> density_;
    BrickWalk walk_;
    ColorAlong color_;
    MotionAlong motion_;
    const Curve* albedo_;
    float factor_;
};

template <typename T> const T* pointer(const std::optional<T>& o) { return o ? &*o : nullptr; }

} // namespace

GridMedium::GridMedium(MediumOptics optics, VoxelGrid grid, double factor, const Transform& worldToRender,
                       GridExtras extras)
    : OpticalMedium(std::move(optics)), density_(std::move(grid), worldToRender), factor_(static_cast<float>(factor)) {
    if (extras.color)
        color_ =
            GridColor{GridField<Vec3>(std::move(extras.color->grid), worldToRender), std::move(extras.color->table)};
    if (extras.velocity) {
        motion_.emplace(std::move(*extras.velocity), worldToRender);
        if (!motion_->moves()) motion_.reset();
    }
    bricks_ = BrickBounds::build(density_.grid(), static_cast<float>(drift()));
    thickest_ = factor_ * static_cast<float>(extinction().maximum());
    if (extras.flame) flame_.emplace(std::move(extras.flame->grid), worldToRender);
    if (extras.temperature) temperature_.emplace(std::move(extras.temperature->grid), worldToRender);
    if (extras.glow) makeEmission(*extras.glow, extras);
    if (density_.grid().empty()) return;
    const Bounds3 box = density_.grid().support();
    const double more = drift();
    for (int corner = 0; corner < 8; ++corner)
        bounds_.add(Vec3(density_.toRender().point(
            {corner & 1 ? static_cast<double>(box.upper.x) + more : static_cast<double>(box.lower.x) - more,
             corner & 2 ? static_cast<double>(box.upper.y) + more : static_cast<double>(box.lower.y) - more,
             corner & 4 ? static_cast<double>(box.upper.z) + more : static_cast<double>(box.lower.z) - more})));
}

void GridMedium::makeEmission(const Glow& glow, const GridExtras& extras) {
    EmissionFields fields{.amount = {&density_, factor_, 0},
                          .temperature = {},
                          .glow = glow,
                          .color = glow.byAlbedo() ? pointer(color_) : nullptr,
                          .motion = pointer(motion_)};
    if (flame_) fields.amount = {&*flame_, static_cast<float>(extras.flame->scale), 0};
    if (glow.thermal()) {
        ABBE_CHECK(temperature_.has_value());
        fields.temperature = {&*temperature_, static_cast<float>(extras.temperature->scale),
                              static_cast<float>(extras.temperature->offset)};
    }
    auto emission = std::make_unique<GridEmission>(fields);
    if (!emission->dark()) emission_ = std::move(emission);
}

MediumWalk* GridMedium::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    const GridParts parts{density_, bricks_, pointer(color_), pointer(motion_), albedo(), factor_, thickest_};
    return space.make<GridWalk>(parts, ray, tMax);
}

} // namespace abbe

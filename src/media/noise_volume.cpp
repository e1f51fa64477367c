#include "media/noise_volume.h"

#include "base/check.h"
#include "volumes/brick_tree_builder.h"
#include "volumes/brick_walk.h"
#include "volumes/noise.h"

namespace abbe {

namespace {

// Bricks are 0.3 features wide, or as much wider as keeps their number, and the pilot's time, below this.
constexpr double kMostBricks = 20'000;

Vec3i bricksFor(const NoiseField& field, const NoiseBox& box) {
    if (field.constant() && box.edge == 0 && std::isinf(box.scaleHeight)) return {8, 8, 8}; // a single node
    const Vec3d size = box.upper - box.lower;
    const auto along = [&](int a, double width) { return std::clamp(std::ceil(size[a] / width), 1.0, kMostBricks); };
    double width = std::max(0.3 * field.pattern().scale, 1e-6 * maxComponent(size));
    while (along(0, width) * along(1, width) * along(2, width) > kMostBricks) width *= 1.1;
    return Vec3i(Vec3d(along(0, width), along(1, width), along(2, width)));
}

// How much the box thins density: near its faces, and with height. Each rises, or falls, with one coordinate only.
float nearFaces(const NoiseBox& box, Vec3d p) {
    if (!(box.edge > 0)) return 1;
    float product = 1;
    for (int a = 0; a < 3; ++a) {
        const double inside = std::min(p[a] - box.lower[a], box.upper[a] - p[a]);
        product *= smoothStep(0, 1, static_cast<float>(inside / box.edge));
    }
    return product;
}
float withHeight(const NoiseBox& box, double height) {
    return static_cast<float>(std::exp(-std::max(0.0, height - box.lower[box.up]) / box.scaleHeight));
}

Vec3d clamped(Vec3d p, const Bounds3d& box) { return min(max(p, box.lower), box.upper); }

// Of their product over a region: each by itself, since they may pull apart along the same axis.
std::pair<float, float> thinningOver(const NoiseBox& box, const Bounds3d& region) {
    const Vec3d middle = (box.lower + box.upper) * 0.5;
    const auto furthest = [&](int a) {
        return middle[a] - region.lower[a] > region.upper[a] - middle[a] ? region.lower[a] : region.upper[a];
    };
    return {nearFaces(box, {furthest(0), furthest(1), furthest(2)}) * withHeight(box, region.upper[box.up]),
            nearFaces(box, clamped(middle, region)) * withHeight(box, region.lower[box.up])};
}

class NoiseWalk final : public MediumWalk {
  public:
    NoiseWalk(const NoiseVolume& volume, const BrickWalk& walk, Vec3d origin, Vec3d direction)
        : volume_(volume), walk_(walk), origin_(origin), direction_(direction) {}

    bool next(MediumSegment& s) noexcept override {
        BrickSegment brick;
        if (!walk_.next(brick)) return false;
        s = {brick.tNear, brick.tFar, brick.minimum, brick.mean, brick.maximum};
        return true;
    }
    float density(float t) noexcept override { return volume_.density(origin_ + direction_ * static_cast<double>(t)); }

  private:
    const NoiseVolume& volume_;
    BrickWalk walk_;
    Vec3d origin_, direction_; // space of the box
};

} // namespace

// In the space of the bricks: eight units a brick.
class NoiseVolume::Sampled final : public PointField {
  public:
    explicit Sampled(const NoiseVolume& volume) : volume_(volume) {
        const Vec3d cells = volume.cellsPerMetre();
        size_ = {1 / cells.x, 1 / cells.y, 1 / cells.z};
    }
    float at(Vec3d p) const noexcept override { return volume_.density(toBox(p)); }
    FieldBounds limits(const Bounds3d& region) const override {
        const auto [low, high] = thinningOver(volume_.box_, {toBox(region.lower), toBox(region.upper)});
        return {low * volume_.field_.minimum(), high, high};
    }

  private:
    Vec3d toBox(Vec3d p) const { return volume_.box_.lower + multiply(p, size_); }

    const NoiseVolume& volume_;
    Vec3d size_;
};

NoiseVolume::NoiseVolume(MediumOptics optics, const NoisePattern& pattern, const NoiseBox& box,
                         const Transform& toRender)
    : OpticalMedium(std::move(optics)), field_(pattern), box_(box), brickCount_(bricksFor(field_, box)),
      thickest_(static_cast<float>(extinction().maximum())) {
    const auto inverse = toRender.inverse();
    ABBE_CHECK(inverse.has_value());
    toBox_ = *inverse;
    const Vec3d cells = cellsPerMetre();
    margin_ = Vec3d{1 / cells.x, 1 / cells.y, 1 / cells.z} / 30.0;
    bricks_ = sampleBounds(Sampled(*this), brickCount_);
    for (int corner = 0; corner < 8; ++corner)
        bounds_.add(Vec3(toRender.point({corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                                         corner & 4 ? box.upper.z : box.lower.z})));
}

Vec3d NoiseVolume::cellsPerMetre() const {
    const Vec3d size = box_.upper - box_.lower, cells = Vec3d(brickCount_) * 8;
    return {cells.x / size.x, cells.y / size.y, cells.z / size.z};
}

float NoiseVolume::density(Vec3d p) const noexcept {
    const Vec3d inside = clamped(p, {box_.lower, box_.upper});
    // Larger cells of the walk reach beyond the box; points computed in float may do so by the bounds' own margin.
    if (maxComponent(abs(p - inside) - margin_) > 0) return 0;
    p = inside;
    const float thin = nearFaces(box_, p) * withHeight(box_, p[box_.up]);
    return thin > 0 ? thin * field_.at(p) : 0;
}

FieldBounds NoiseVolume::boundsAt(Vec3d p) const { return bricks_.at(Vec3(multiply(p - box_.lower, cellsPerMetre()))); }

MediumWalk* NoiseVolume::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    const Vec3d origin = toBox_.point(Vec3d(ray.origin)), direction = toBox_.vector(Vec3d(ray.direction));
    const Vec3d cells = cellsPerMetre();
    const BrickWalk walk(bricks_, multiply(origin - box_.lower, cells), multiply(direction, cells), 0, tMax, thickest_);
    return space.make<NoiseWalk>(*this, walk, origin, direction);
}

} // namespace abbe

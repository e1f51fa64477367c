#include "media/grid_emission.h"

#include "math/hash.h"

namespace abbe {

namespace {

class GridEmissionWalk final : public EmissionWalk {
  public:
    GridEmissionWalk(const EmissionFields& fields, const BrickBounds& bricks, const Ray& ray, float tMax)
        : walk_(bricks, fields.amount.field->toIndex().point(Vec3d(ray.origin)),
                fields.amount.field->toIndex().vector(Vec3d(ray.direction)), 0, tMax),
          along_(fields, Vec3d(ray.origin), Vec3d(ray.direction), ray.time) {}

    bool next(MediumSegment& s) noexcept override {
        BrickSegment brick;
        if (!walk_.next(brick)) return false;
        s = {brick.tNear, brick.tFar, brick.minimum, brick.mean, brick.maximum};
        return true;
    }
    Spectrum emitted(float t, const Wavelengths& lambda) noexcept override { return along_.emitted(t, lambda); }

  private:
    BrickWalk walk_;
    EmissionAlong along_;
};

// What is scattered in places, whatever its share: all that could be absorbed.
Glow brightest(const EmissionFields& fields) { return fields.color ? fields.glow.withoutAlbedo() : fields.glow; }

} // namespace

GridEmission::GridEmission(const EmissionFields& fields) : fields_(fields) {
    const GlowTable table(brightest(fields), hottest(fields));
    bricks_ = emissionBricks(fields_, table);
    if (bricks_.empty()) return;
    sampler_.emplace(bricks_);
    const GridField<float>& grid = *fields_.amount.field;
    perVoxel_ = std::abs(grid.toIndex().determinant());
    edge_ = static_cast<float>(8 / std::cbrt(perVoxel_));
    power_ = estimatePower(table);
    centre_ = Vec3(grid.toRender().point(sampler_->centre()));
}

Bounds3 GridEmission::bounds() const {
    const Bounds3d b = sampler_->bounds();
    Bounds3 result;
    for (int i = 0; i < 8; ++i) {
        const Vec3d corner(i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z);
        result.add(Vec3(fields_.amount.field->toRender().point(corner)));
    }
    return result;
}

EmissionWalk* GridEmission::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    return space.make<GridEmissionWalk>(fields_, bricks_, ray, tMax);
}

float GridEmission::pdfSolidAngle(Vec3 from, Vec3 p) const noexcept {
    const Vec3 way = p - from;
    const double perVolume = sampler_->density(Vec3(fields_.amount.field->toIndex().point(Vec3d(p)))) * perVoxel_;
    return static_cast<float>(perVolume * static_cast<double>(dot(way, way) * edge_));
}

Vec3 GridEmission::samplePoint(Vec2 u) const noexcept {
    return Vec3(fields_.amount.field->toRender().point(sampler_->sample(u)));
}

Spectrum GridEmission::emitted(Vec3 p, float time, const Wavelengths& lambda) const noexcept {
    return EmissionAlong(fields_, Vec3d(p), {}, time).emitted(0, lambda);
}

// 4π times the integral of the emission, by points of its own density.
double GridEmission::estimatePower(const GlowTable& table) const {
    constexpr std::uint32_t kCount = 16384;
    double sum = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const float v = static_cast<float>(mix32(i + 1) >> 8) * 0x1p-24f;
        const Vec3d p = sampler_->sample({(static_cast<float>(i) + 0.5f) / kCount, v});
        const Vec3d place = fields_.amount.field->toRender().point(p);
        const auto s = EmissionAlong(fields_, place, {}, 0.5f).state(0);
        const double density = sampler_->density(Vec3(p)) * perVoxel_;
        if (s.amount > 0 && density > 0) sum += static_cast<double>(s.amount * table.watts(s.kelvin)) / density;
    }
    return 4 * kPiD * sum / kCount;
}

std::optional<LightSample> VolumeLight::sample(const Receiver& from, std::uint32_t, Vec2 u, const Wavelengths& lambda,
                                               float time) const noexcept {
    const Vec3 p = emission_.samplePoint(u), way = p - from.p;
    const float distance = length(way);
    // As found along a ray: a point that rounding has put into the next brick has that brick's density.
    const float pdf = emission_.pdfSolidAngle(from.p, p);
    if (!(distance > 0) || !(pdf > 0) || !(pdf < kInfinity)) return std::nullopt;
    const Spectrum emitted = emission_.emitted(p, time, lambda);
    if (!anyNonZero(emitted)) return std::nullopt;
    return std::optional<LightSample>(std::in_place, way * (1 / distance), p, distance, emitted * emission_.edge(),
                                      pdf);
}

} // namespace abbe

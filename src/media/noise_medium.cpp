#include "media/noise_medium.h"

#include "base/check.h"

namespace abbe {

namespace {

class UnboundedNoiseWalk final : public MediumWalk {
  public:
    UnboundedNoiseWalk(const NoiseField& field, Vec3d origin, Vec3d direction, float tMax)
        : field_(field), origin_(origin), direction_(direction), tMax_(tMax) {}
    bool next(MediumSegment& segment) noexcept override {
        if (done_) return false;
        done_ = true;
        segment = {0, tMax_, field_.minimum(), field_.mean(), 1};
        return true;
    }
    float density(float t) noexcept override { return field_.at(origin_ + direction_ * static_cast<double>(t)); }

  private:
    const NoiseField& field_;
    Vec3d origin_, direction_; // space of the pattern
    float tMax_;
    bool done_ = false;
};

} // namespace

NoiseMedium::NoiseMedium(MediumOptics optics, const NoisePattern& pattern, const Transform& toWorld)
    : OpticalMedium(std::move(optics)), field_(pattern) {
    const auto inverse = toWorld.inverse();
    ABBE_CHECK(inverse.has_value());
    toPattern_ = *inverse;
}

Bounds3 NoiseMedium::bounds() const {
    return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
}

MediumWalk* NoiseMedium::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    return space.make<UnboundedNoiseWalk>(field_, toPattern_.point(Vec3d(ray.origin) + origin_),
                                          toPattern_.vector(Vec3d(ray.direction)), tMax);
}

} // namespace abbe

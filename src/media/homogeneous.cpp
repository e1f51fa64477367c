#include "media/homogeneous.h"

namespace abbe {

namespace {

class WholeRay final : public MediumWalk {
  public:
    explicit WholeRay(float tMax) : tMax_(tMax) {}
    bool next(MediumSegment& segment) noexcept override {
        if (done_) return false;
        done_ = true;
        segment = {0, tMax_, 1, 1, 1};
        return true;
    }
    float density(float) noexcept override { return 1; }

  private:
    float tMax_;
    bool done_ = false;
};

} // namespace

Bounds3 HomogeneousMedium::bounds() const {
    return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
}

MediumWalk* HomogeneousMedium::walk(const Ray&, float tMax, WalkSpace& space) const noexcept {
    return space.make<WholeRay>(tMax);
}

schema::TypeInfo homogeneousType() {
    std::vector<schema::FieldInfo> fields;
    addOpticsFields<HomogeneousParams>(fields);
    return {schema::Kind::medium,
            "homogeneous",
            "The same everywhere inside the shape that it fills.",
            "medium milk homogeneous { scattering 1200 per-m; absorption 0.4 per-m }",
            true,
            std::move(fields)};
}

} // namespace abbe

#include "media/atmosphere.h"

namespace abbe {

namespace {

// From where density has fallen to 1e-20 on there is nothing.
constexpr double kTopInScaleHeights = 46;
// Pieces in which density changes by a factor of e^(1/2) at most, or of so small an optical depth that next to no ray
// collides in them, real or not: in clear air steps would cost more than collisions.
constexpr double kOpticalStep = 0.5;
constexpr double kThin = 0.25;

// Heights along the ray are linear in t: h(t) = height + slope t, in scale heights above the ground.
class AtmosphereWalk final : public MediumWalk {
  public:
    // `extinction`: greatest, at density 1 and per unit of t.
    AtmosphereWalk(double height, double slope, double extinction, float tMax)
        : height_(height), slope_(slope), perHeight_(extinction / std::abs(slope)), end_(static_cast<double>(tMax)) {}

    bool next(MediumSegment& s) noexcept override {
        while (t_ < end_) {
            const double here = height_ + slope_ * t_;
            const double stop = std::min(end_, boundaryAfter(here));
            const double there = std::isinf(stop) ? (slope_ > 0 ? kTopInScaleHeights : here) : height_ + slope_ * stop;
            const double from = from_ = t_;
            t_ = stop;
            const double a = value(here), b = value(there);
            if (!(std::max(a, b) > 0) || !(stop > from)) continue;
            s = {static_cast<float>(from), static_cast<float>(stop), static_cast<float>(std::min(a, b)),
                 static_cast<float>(average(here, there)), static_cast<float>(std::max(a, b))};
            return s.tFar > s.tNear;
        }
        return false;
    }
    // Within the piece: its ends, rounded to float, may lie a little outside of it, where the bounds do not hold.
    float density(float t) noexcept override {
        return static_cast<float>(value(height_ + slope_ * std::clamp(static_cast<double>(t), from_, t_)));
    }

  private:
    static double value(double h) { return h <= 0 ? 1 : h < kTopInScaleHeights ? std::exp(-h) : 0; }
    // Of the density between two heights that are both above the ground or both below it.
    static double average(double a, double b) {
        if (a <= 0 && b <= 0) return 1;
        // From the lower one: from far above, e^-a and its growth on the way down are 0 and infinite.
        const double d = std::abs(b - a);
        return d < 1e-9 ? value(a) : value(std::min(a, b)) * -std::expm1(-d) / d;
    }
    // Distance at which the piece that begins at height `here` ends.
    double boundaryAfter(double here) const {
        constexpr double kNever = std::numeric_limits<double>::infinity();
        const auto at = [&](double h) { return std::max((h - height_) / slope_, t_ + kSmallest * std::abs(t_)); };
        if (slope_ > 0) {
            if (here < 0) return at(0);
            if (here >= kTopInScaleHeights) return kNever;
            const double step = kOpticalStep * (std::floor(here / kOpticalStep * (1 + kSmallest)) + 1);
            return at(std::min(std::max(step, here + kThin * std::exp(here) / perHeight_), kTopInScaleHeights));
        }
        if (slope_ < 0) {
            if (here <= 0) return kNever;
            if (here > kTopInScaleHeights) return at(kTopInScaleHeights);
            double low = kOpticalStep * (std::ceil(here / kOpticalStep * (1 - kSmallest)) - 1);
            for (double deep = 2 * kOpticalStep; low > 0; deep *= 2) {
                const double lower = std::max(here - deep, 0.0);
                if (perHeight_ * std::exp(-lower) * (here - lower) > kThin) break;
                low = std::min(low, lower);
            }
            return at(low);
        }
        return kNever;
    }
    static constexpr double kSmallest = 1e-14;

    double height_, slope_, perHeight_, end_;
    double from_ = 0, t_ = 0; // of the piece that was given last
};

} // namespace

Atmosphere::Atmosphere(MediumOptics optics, Vec3 up, double ground, double scaleHeight)
    : OpticalMedium(std::move(optics)), up_(up), ground_(ground), scaleHeight_(scaleHeight) {}

Bounds3 Atmosphere::bounds() const { return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}}; }

MediumWalk* Atmosphere::walk(const Ray& ray, float tMax, WalkSpace& space) const noexcept {
    const Vec3d up(up_);
    const double height = (dot(Vec3d(ray.origin), up) - ground_) / scaleHeight_;
    return space.make<AtmosphereWalk>(height, dot(Vec3d(ray.direction), up) / scaleHeight_, extinction().maximum(),
                                      tMax);
}

schema::TypeInfo atmosphereType() {
    using namespace schema;
    std::vector<FieldInfo> fields = {
        field(FieldType::quantity, "scale-height", &AtmosphereParams::scaleHeight)
            .unit({Dimension::length})
            .range(1e-6, 1e9)
            .synonyms({"falloff", "height_falloff"})
            .doc("Height over which density falls to 1/e; the same at any height when absent.")
            .example("scale-height 8 km"),
        field(FieldType::quantity, "ground", &AtmosphereParams::ground)
            .unit({Dimension::length})
            .byDefault("0")
            .doc("Height up to which density is 1.")
            .example("ground 2 m"),
    };
    addOpticsFields<AtmosphereParams>(fields);
    return {Kind::volume,
            "atmosphere",
            "Air, haze or fog everywhere, with `scale-height` thinner at height.",
            "volume haze atmosphere { extinction 0.02 per-km; phase rayleigh }",
            false,
            std::move(fields)};
}

} // namespace abbe

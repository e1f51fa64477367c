#include "media/volume_light.h"

namespace abbe {

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

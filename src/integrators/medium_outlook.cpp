// What MediumTracker can say of a ray without tracking it.
#include "integrators/medium_tracker.h"

#include <limits>

namespace abbe {

namespace {

// The part of the ray within a box that may be infinite.
RayExtent clip(const Bounds3& box, const Ray& ray, float tMax) {
    RayExtent e{0, tMax};
    for (int a = 0; a < 3; ++a) {
        const float o = ray.origin[a], d = ray.direction[a];
        if (d == 0) {
            if (!(o >= box.lower[a] && o <= box.upper[a])) return {};
            continue;
        }
        const float t0 = (box.lower[a] - o) / d, t1 = (box.upper[a] - o) / d;
        e.tNear = std::max(e.tNear, std::min(t0, t1));
        e.tFar = std::min(e.tFar, std::max(t0, t1));
    }
    return e;
}

} // namespace

RayExtent MediumTracker::extent(const Ray& ray, float tMax, const MediumStack& inside) const {
    if (inside.size() > 0) return {0, tMax};
    RayExtent all;
    for (const Medium* medium : open_) {
        const RayExtent e = clip(medium->bounds(), ray, tMax);
        if (e.empty()) continue;
        all = all.empty() ? e : RayExtent{std::min(all.tNear, e.tNear), std::max(all.tFar, e.tFar)};
    }
    return all;
}

float MediumTracker::expected(const Ray& ray, float t, const MediumStack& inside, const Wavelengths& lambda,
                              std::vector<InScattering>* there) {
    if (there) there->clear();
    start(ray, t, inside, lambda);
    double passed = 0, rate = 0;
    for (Active& a : active_) {
        const double extinction = static_cast<double>(mean(a.extinction));
        const MediumSegment& s = a.segment;
        for (bool more = true; more; more = a.walk->next(a.segment)) {
            passed += extinction * static_cast<double>(s.mean) * static_cast<double>(s.tFar - s.tNear);
            if (s.tFar < t) continue;
            rate += extinction * static_cast<double>(s.mean);
            if (!there) continue;
            const Spectrum albedo = a.medium->albedoVaries() ? a.walk->albedo(t, lambda) : a.albedo;
            const float density = a.walk->density(t);
            note(density, std::numeric_limits<float>::max(), *a.medium); // no bound counts here
            there->push_back({a.medium, a.extinction * albedo * density});
        }
    }
    return static_cast<float>(rate * std::exp(-passed));
}

} // namespace abbe

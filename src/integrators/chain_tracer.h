// Follows a narrow beam over a chain of delta interfaces.
#pragma once

#include "integrators/light_target.h"
#include "integrators/medium_tracker.h"
#include "integrators/specular_chain.h"
#include "integrators/surroundings.h"
#include "render/scene.h"

#include <cstdint>
#include <unordered_set>

namespace abbe {

// Where light is asked for, and what surrounds that point on the side of the light.
struct ChainStart {
    Receiver receiver{Vec3()};
    Vec3 pError{}, ng{}; // of a surface; ng is unit. 0 in a medium
    float time = 0;      // Ray::time
    Surroundings around{};
};

// Geometry is exact to double next to each hit (Shape::patch), so that what lenses magnify is not the rounding of
// single precision. Directions are those of the hero.
class ChainTracer {
  public:
    // All must outlive it. `followed`: the shapes that chains may run over, those of casterCandidates().
    ChainTracer(const Scene& scene, const std::unordered_set<const Shape*>& followed, const ChainStart& start,
                const LightTarget& target, const Wavelengths& lambda)
        : scene_(scene), followed_(followed), start_(start), target_(target), lambda_(lambda) {}

    // The chain whose first direction is this, with these events; `first`: the shape that it must meet first. False if
    // there is none: it meets something else, or cannot reflect or refract like that. Nothing is asked about what lies
    // between its end and the light, nor about how much light it carries.
    bool trace(Vec3d direction, ChainSignature signature, const Shape* first, SpecularChain& chain);
    // Whether anything lies between the end of a solution and the light; sets chain.clearness.
    bool reachesLight(SpecularChain& chain);
    // From now on clearness is also that of media along the way, estimated without bias; or no more (null).
    void lookAtMedia(MediumTracker* media, RandomStream& random) { media_ = media, random_ = &random; }

    std::uint64_t rays() const { return rays_; }

  private:
    // What neighbours of a ray do, by two parameters: [Igehy1999].
    struct Beam {
        std::array<Vec3d, 2> p, d;
    };

    bool meet(Vec3 spawn, Vec3d direction, Surroundings& here, Surroundings& beyond, ChainVertex&);
    float straightOn(SurfaceHit&, const Ray&, Surroundings& here, Surroundings& beyond) const;
    // `end`: the surface there, if any.
    Spectrum clearness(const Surroundings& here, const SurfaceHit* end, const Ray&, float distance) const;
    bool turn(ChainEvent, const SurfacePatch&, ChainVertex&, Beam&) const;
    void aim(const Beam&, SpecularChain&) const;

    const Scene& scene_;
    const std::unordered_set<const Shape*>& followed_;
    const ChainStart& start_;
    const LightTarget& target_;
    const Wavelengths& lambda_;
    MediumTracker* media_ = nullptr; // null: not looked at
    RandomStream* random_ = nullptr;
    Surroundings behind_; // after the last vertex of the last trace
    std::uint64_t rays_ = 0;
};

} // namespace abbe

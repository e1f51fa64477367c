// Chains of delta interfaces from a point to a point of a light: following one, and finding them.
#pragma once

#include "caustics/shared/chain_signature.h"
#include "light_sampling/light_target.h"
#include "render/scene.h"
#include "render/surface_hit.h"
#include "spectrum/spectrum.h"
#include "transport/medium_tracker.h"
#include "transport/surroundings.h"

#include <array>
#include <cstdint>
#include <unordered_set>

namespace abbe {

struct ChainVertex {
    SurfaceHit hit; // with arrival and outside
    Vec3d p;
    Vec3d in, out;           // unit, in the direction of the camera path
    Spectrum clearness{1.f}; // of the way from the vertex before: absorption and openings
};

// As a camera path runs: from the receiver to the light. Render space, in double.
struct SpecularChain {
    std::array<ChainVertex, kLongestManifoldChain> vertices;
    int length = 0;
    Vec3d direction;            // unit, at the receiver
    Vec2d miss;                 // of the last direction past the target; 0 for a solution
    double jacobian[2][2] = {}; // of the miss by the direction, across two axes (tangentsOf); exact where the miss is 0
    double spread2 = 1; // m², what turns solid angle at the last vertex into area at the target; 1 for far targets
    Spectrum clearness{1.f}; // of the way from the last vertex to the light

    const ChainVertex& last() const { return vertices[static_cast<std::size_t>(length - 1)]; }
    double determinant() const { return jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0]; }
    double miss2() const { return miss.x * miss.x + miss.y * miss.y; }
};

// The point at which a chain starts, and what surrounds that point on the side of the light.
struct ChainStart {
    Receiver receiver{Vec3()};
    Vec3 pError{}, ng{}; // of a surface; ng is unit. 0 in a medium
    float time = 0;      // Ray::time
    Surroundings around{};
};

// Follows a narrow beam over a chain of delta interfaces. Geometry is exact to double next to each hit (Shape::patch),
// so that what lenses magnify is not the rounding of single precision. Directions are those of the hero.
class ChainTracer {
  public:
    // All must outlive it. `followed`: the shapes that chains may run over, those of casterCandidates().
    ChainTracer(const Scene& scene, const std::unordered_set<const Shape*>& followed, const ChainStart& start,
                const LightTarget& target, const Wavelengths& lambda)
        : scene_(scene), followed_(followed), start_(start), target_(target), lambda_(lambda) {}

    // The chain whose first direction is this, with these events; `first`: the shape that it must hit first. False if
    // there is none: it hits something else, or cannot reflect or refract like that. It does not matter what lies
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

    bool intersect(Vec3 spawn, Vec3d direction, Surroundings& here, Surroundings& beyond, ChainVertex&);
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

// Finds chains of delta interfaces that lead to a point of a light. Newton's method for the first direction of a chain
// whose last one points at the target: shooting, where [Hanika2015] and [Zeltner2020] move all vertices at once. The
// only unknown is a direction, whatever the length of the chain, and every iterate is a path that light can take.
// Deterministic: which solution it finds, or none, is a function of the direction that it starts from.
class ChainSolver {
  public:
    // Misses of solutions are below this (rad).
    static constexpr double kTolerance = 1e-10;
    static constexpr int kMaxIterations = 32;
    static constexpr int kMaxHalvings = 10;
    // Determinants below this share of the squared entries count as 0: no step, and no solution.
    static constexpr double kSingular = 1e-12;

    // `reach`: half the angle (rad) that the first interface fills, at least about: no step is longer.
    ChainSolver(ChainTracer& tracer, double reach) : tracer_(tracer), reach_(reach) {}

    // Null if none was found. What is returned belongs to the solver, until the next call.
    const SpecularChain* solve(Vec3d direction, ChainSignature, const Shape* first);
    // The same, to complete it (ChainTracer::reachesLight).
    SpecularChain& solution() { return chains_[current_]; }
    std::uint64_t iterations() const { return iterations_; }

  private:
    bool step(ChainSignature, const Shape* first);

    ChainTracer& tracer_;
    double reach_;
    SpecularChain chains_[2]; // the present one, and the one that is tried
    std::size_t current_ = 0;
    std::uint64_t iterations_ = 0;
};

} // namespace abbe

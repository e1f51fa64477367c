// What camera paths do for caustics: weights against light paths, manifold next-event estimation, and what they leave
// to merging and to probes of glints.
#pragma once

#include "caustics/glints/glint_plan.h"
#include "caustics/glints/glint_search.h"
#include "caustics/light_tracing/light_path_weights.h"
#include "caustics/manifold/manifold_nee.h"
#include "caustics/merging/merge_plan.h"
#include "path_tracing/mis_weights.h"

#include <span>

namespace abbe {

// What the caustics of a camera path need to know of its start. All outlive the path.
struct CausticStart {
    const CameraRay& camera;
    VertexArenas& arenas;
    Vec2 film;                                  // where it starts, as CameraSample::film
    std::span<const std::uint32_t> glintsOfRow; // that may be there and are probed; empty: nothing is left out
};

// Light that is found by merging (MergePlan): where a camera path has gathered it.
class MergingExclusion {
  public:
    // At a surface or in a medium, before the path goes on. `reversible`: light paths end at what is not. `spreads`:
    // light that arrives there, and not by deltas alone; `specular`: the path has hit nothing but deltas so far.
    void arrive(const MergePlan* plan, bool reversible, bool spreads, std::uint32_t depth, bool specular) {
        if (!plan) return;
        gathers_ = reversible && depth > 0 && specular && spreads;
        gathered_ &= reversible;
    }
    // The path has gone on.
    void scatter(bool delta) { gathered_ |= gathers_ && !delta; }
    // Whether the light that is hit is left to merging. `delta`: the path came to it from one.
    bool has(const MergePlan* plan, const Light* light, bool delta) const {
        return gathered_ && delta && plan->lights.contains(light);
    }

  private:
    bool gathers_ = false;  // at a vertex at which merging gathers light
    bool gathered_ = false; // behind one
};

// Glints, small images of lights in mirrors and clear glass, that are probed instead (GlintPlan).
class GlintExclusion {
  public:
    GlintExclusion(std::span<const std::uint32_t> glintsOfRow, Vec2 film) : glintsOfRow_(glintsOfRow), film_(film) {}

    // At a surface, before the path goes on. `specular`: it has hit nothing but deltas so far.
    void arrive(const Bsdf& bsdf, Vec3 wo, const BsdfSample& next, bool specular) {
        if (glintsOfRow_.empty() || !specular || !next.lobe.has(Lobe::delta)) return;
        events_.add(chainEvent(next.lobe.has(Lobe::transmission)));
        forced_ = forced_ && isForced(bsdf, wo, next);
    }
    // Whether the light that is hit is left to probes.
    bool have(const GlintPlan* plan, const Light* light, bool specular) const {
        if (glintsOfRow_.empty() || !specular || !forced_ || events_.length() == 0) return false;
        return plan->has(light) && plan->covers(glintsOfRow_, events_, film_);
    }

  private:
    std::span<const std::uint32_t> glintsOfRow_;
    Vec2 film_;
    ChainSignature events_; // so far
    bool forced_ = true;    // all of them as forcedLobe() has them
};

// The parts of one camera path.
template <EffectBits E> class CameraCaustics<E, true> {
  public:
    CameraCaustics(PathWalk<E>& walk, const CausticStart& start)
        : lightPaths(walk, start.camera, start.arenas), walk_(walk), manifold_(walk),
          glints_(start.glintsOfRow, start.film) {}

    // At a surface, after next-event estimation. `next`: where the path goes on, null if it does not.
    void sample(const SurfaceHit& hit, const Bsdf& bsdf, const EyeDirection& eye, std::uint32_t depth,
                const BsdfSample* next) {
        manifold_.sample(hit, bsdf, eye, depth, specular_);
        merged_.arrive(walk_.context.merging, hit.material->reversible(),
                       bsdf.lobes().any(Lobes(Lobe::diffuse) | Lobe::glossy), depth, specular_);
        if (next) glints_.arrive(bsdf, eye.wo, *next, specular_);
    }
    // The path has gone on from there in the direction.
    void scatter(const SurfaceHit& hit, const BsdfSample& next, const EyeDirection& eye, Vec3 direction) {
        lightPaths.scatter(next, eye.woRender, direction);
        manifold_.follow(hit, next, direction);
        merged_.scatter(walk_.path.delta);
        specular_ &= walk_.path.delta;
    }
    void scatterInMedium(std::uint32_t depth) {
        merged_.arrive(walk_.context.merging, true, true, depth, specular_);
        merged_.scatter(false);
        specular_ = false;
        manifold_.scatterInMedium();
        lightPaths.scatterInMedium();
    }
    // Whether the light that is hit is found in another way: an area light's,
    bool leaveOut(const SurfaceHit& hit) const {
        return leaveOut(hit.light, [&] { return LightTarget::ofHit(hit, walk_.path.time); });
    }
    // or that of one far away, in the direction.
    bool leaveOut(const DistantLight& light, Vec3 direction) const {
        return leaveOut(&light, [&] { return LightTarget::ofHit(light, direction, walk_.path.time); });
    }

    LightPathWeights<E> lightPaths;

  private:
    template <typename Target> bool leaveOut(const Light* light, Target target) const {
        const PathContext& context = walk_.context;
        return glints_.have(context.glints, light, specular_) ||
               merged_.has(context.merging, light, walk_.path.delta) || manifold_.covers(target);
    }

    PathWalk<E>& walk_;
    ManifoldNee<E> manifold_;
    MergingExclusion merged_;
    GlintExclusion glints_;
    bool specular_ = true; // nothing but deltas so far
};

} // namespace abbe

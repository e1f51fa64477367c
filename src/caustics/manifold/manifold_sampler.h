// Specular manifold sampling: caustics that are seen through glass or in mirrors [Zeltner2020].
#pragma once

#include "caustics/manifold/chain_tracer.h"
#include "caustics/manifold/manifold_plan.h"
#include "caustics/shared/chain_signature.h"
#include "math/distribution.h"
#include "math/hash.h"
#include "math/vec.h"
#include "render/bsdf.h"
#include "spectrum/spectrum.h"
#include "transport/path_context.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace abbe {

class Light;

struct ManifoldSample {
    Vec3 wi; // unit, from the receiver towards the first interface
    // W·m⁻²·nm⁻¹ on a surface that faces wi: what f(wo, wi) |cos θ| or a phase function is to be multiplied with. All
    // densities are divided out.
    Spectrum irradiance{0.f};
    // Of the chain, by the light as a path that hits it would see it: with the irradiance above the second moment that
    // chance would have in place of this. 0 for lights that nobody hits by chance.
    Spectrum radiance{0.f};
    const Light* light = nullptr;
    int length = 0; // interfaces on the way
    // The chain refracts where indices vary with wavelength: it is that of the hero alone. Lane 0 then counts for all
    // of them, eightfold, and the others are 0 (as PathWalk::endSecondaryWavelengths; divide by the hero's own ratio of
    // densities there).
    bool heroOnly = false;
    bool capped = false; // trials ended before the solution came back: `irradiance` is too low in the mean
};

// Which kind of chain is looked for, and the probability of that choice.
struct ManifoldChoice {
    std::uint32_t caster = 0;
    ChainSignature signature;
    float probability = 0;
};

// What a camera path has hit since the last vertex at which manifold sampling was tried. Plain data of a path;
// ManifoldSampler::follow() and covers() look after it.
struct CoveredChain {
    static constexpr std::uint32_t kNone = 0xffffffffu;

    // At a vertex where light was looked for by ManifoldSampler::sample(), whatever came of it.
    void start() { *this = {.following = true}; }
    // At any other vertex that is not a delta.
    void stop() { following = false; }

    ChainSignature signature = {};
    std::uint32_t caster = kNone; // the first interface's place in the plan
    bool following = false;
};

// Finds light that small sources send over one to three delta interfaces to a point that is not a mirror itself. Light
// and chain are drawn; then first directions towards the caster, from each of which Newton's method finds a solution or
// none. A solution that was found with probability p counts 1/p, for which the number of further trials until it comes
// back is an estimate without bias [Zeltner2020]. There is no density of these paths, so that the path tracer leaves
// out exactly those that follow() and covers() know, instead of a weight for each technique. That is decided by the
// path alone: by its events and shapes, and by how large the light appears by way of it.
//
// Immutable, thread-safe; the scene must outlive it.
class ManifoldSampler {
  public:
    // Requires casters and lights of the scene, as ManifoldPlan states them.
    ManifoldSampler(const Scene&, ManifoldPlan);

    // Nothing to look for.
    bool empty() const { return plan_.casters.empty() || plan_.lights.empty(); }
    const ManifoldPlan& plan() const { return plan_; }

    // An estimate of all that is covered; nothing for no light. Requires !empty(). `media`: null where the scene has
    // none.
    std::optional<ManifoldSample> sample(const ChainStart&, const Wavelengths&, RandomStream&, ManifoldCounts&,
                                         MediumTracker* media = nullptr) const noexcept;
    // Its two steps. Of a light, its part and a point of it, or a direction; may be nothing:
    std::optional<LightTarget> drawTarget(const Wavelengths&, float time, RandomStream&) const noexcept;
    // Of a caster and a signature, for a receiver at p:
    ManifoldChoice choose(Vec3 p, RandomStream&) const noexcept;
    // The shapes that chains run over: those of casterCandidates() without obstacle.
    const std::unordered_set<const Shape*>& followed() const { return followed_; }
    // An estimate of the sum over all solutions with this target and signature, by one of them.
    std::optional<ManifoldSample> estimate(const ChainStart&, const LightTarget&, const ManifoldChoice&,
                                           const Wavelengths&, RandomStream&, ManifoldCounts&,
                                           MediumTracker* media = nullptr) const noexcept;

    // A camera path went on from a place of the shape by this lobe.
    void follow(CoveredChain& chain, const Shape*, Lobes lobe) const noexcept;
    // Whether this light by such a chain is covered, as far as its shapes and events tell.
    bool coversKind(const CoveredChain& chain, const Light*) const noexcept;
    // Whether light that the path hits next is covered: manifold sampling at the start of the chain has it already.
    // `start` and `direction` as there; `hit`: LightTarget::ofHit(). Cheap where no such light can be covered.
    bool covers(const CoveredChain& chain, const ChainStart& start, Vec3 direction, const LightTarget& hit,
                const Wavelengths&) const noexcept;

  private:
    // Whether the light's image is, so that chains to it are covered.
    bool isSmall(const SpecularChain&, const LightTarget&) const noexcept;

    const Scene& scene_;
    ManifoldPlan plan_;
    std::optional<Distribution1D> lightChoice_;
    std::vector<Distribution1D> signatureChoice_; // by caster
    std::unordered_set<const Shape*> followed_;
    std::unordered_map<const Shape*, std::uint32_t> casters_;
    std::unordered_map<const Light*, std::uint32_t> lights_;
};

// Who hears of light that manifold sampling looks for: pilots. Called by one thread.
class ManifoldListener {
  public:
    virtual ~ManifoldListener() = default;
    // For a path of throughput `beta` an estimate at `start` came to `light` at the eye; a path that hits the same
    // light by chance would bring `chance`. Both 0 if nothing was found. Called for each of the plan's estimates;
    // `light` is that of one, not its share of the mean.
    virtual void sampled(const ChainStart& start, const Spectrum& beta, const Wavelengths&, const Spectrum& light,
                         const Spectrum& chance) = 0;
};

} // namespace abbe

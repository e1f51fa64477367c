// What every technique for caustics is: light tracing, manifold sampling, photon merging, glint probing.
#pragma once

#include "caustics/shared/kernel_jobs.h"
#include "render/integrator.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_set>

namespace abbe {

class Light;

using LightSet = std::unordered_set<const Light*>;

// What a camera ray costs in rays where its path tells how likely light paths are to find the same (LightPathKernel).
inline constexpr double kCostBesideLightPaths = 1.4;

// What pilots are sent with.
struct PilotInput {
    const PathContext& context; // with the plans of techniques that come before
    const Film& film;           // tells its filter and whether it takes merged light alone
    const LightPathKernel& kernel;
    const RouletteReference& roulette; // of the frame
    const CausticFindings& found;      // by techniques that come before
    const std::function<bool()>& stop; // cuts it short, without a plan
};

// Of the samples [first, last) of each replicate the part of one block of so many; but for those before `from`, whose
// units are samples of replicates: all of the first replicate, then all of the second.
struct BlockJob {
    std::uint32_t first = 0, last = 0;
    std::uint32_t block = 0, blocks = 1;
    PortionPlace from = {};

    std::uint32_t units(const Film& film) const {
        return (last - first) * static_cast<std::uint32_t>(film.replicates());
    }
};

// Finds light that camera paths find seldom or never, and leaves all else to others: what one technique covers, camera
// paths and techniques before it leave out or weigh against it. A plan is frozen before the first sample, and depends
// on the scene, the frame, the pixel filter, the settings and the size of the pilots alone.
class CausticTechnique {
  public:
    struct Rays {
        std::uint64_t pilot = 0; // that it took to plan
        double beside = 0;       // that it takes beside each camera path, in those of camera paths
    };

    virtual ~CausticTechnique() = default;

    // Finds out by pilots what light there is for it, and plans to render that if it pays. Once.
    virtual void plan(const PilotInput&) = 0;
    // Whether there is anything to render.
    virtual bool used() const = 0;
    // Tells the paths of a render, and pilots after this one's; refers to the plan, which must outlive the context.
    virtual void giveTo(PathContext&) const = 0;
    // Nothing if it only takes part in camera paths. A context that giveTo() has seen.
    virtual std::optional<TileResult> render(const PathContext&, const LightPathKernel&, Film&, const BlockJob&) const {
        return std::nullopt;
    }
    virtual void report(CausticFindings&) const = 0;
    virtual Rays rays() const = 0;
    // Lights of which it finds what no technique before it finds as well; null: none.
    virtual const LightSet* takes() const { return nullptr; }
    // Leaves to a later technique what that one finds better of the light that it takes.
    virtual void leave(const Scene&, const LightSet&) {}
};

} // namespace abbe

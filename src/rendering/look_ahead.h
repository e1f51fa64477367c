// What is found out about a frame before the first sample of its image.
#pragma once

#include "caustics/shared/kernel_jobs.h"
#include "light_sampling/light_arrival.h"
#include "render/integrator.h"
#include "rendering/sampling_plan.h"
#include "transport/roulette.h"
#include "transport/solid_walk.h"

#include <functional>
#include <vector>

namespace abbe {

// Of the directions about what the camera sees, each as a matte surface weighs it, the share that lead out of the
// scene; 1 where it sees nothing. By a thousand pairs of rays that depend on scene and frame alone.
float openness(const Scene&, PixelBounds frame);

// So many rays of a path, in the mean over the frame, are worth a look at why.
inline constexpr double kManyRays = 100;

// Paths that go round and round and lose nothing. Takes the samples of the cells with the most rays again and looks
// where their paths go after kLongPath vertices: nothing if that is hardly ever where surfaces take no light away.
// Whose rays are counted is the context of the pilot, with its roulette.
EndlessPaths findEndlessPaths(const PathContext&, TileFunction, const PilotFilm&, const RouletteReference&);

class RenderState;

// From samples of seeds of their own, which are never part of the image; of the whole frame, whatever part of it is
// rendered.
struct LookAhead {
    RouletteReference roulette;
    PulledShares pulled; // of walks in solids
    std::optional<LightArrival> arrival;
    SamplingPlan plan;             // even unless the settings ask for more
    std::vector<double> tileCosts; // of a sample in each tile of the state, in rays
    std::uint64_t rays = 0;        // that it took
    FramePreview first;
    double raysOfPath = 0; // of a camera path, in the mean over the frame

    LookFindings findings(const Scene&) const;
    // Of what it learnt, all that paths ask.
    void giveTo(PathContext& context) const {
        context.pulled = &pulled;
        context.arrival = arrival ? &*arrival : nullptr;
    }
};

// Rough, and no longer the same from one run to the next, if `stop` says so on the way.
LookAhead lookAhead(const PathContext&, TileFunction, const Film&, const RenderState&,
                    const std::function<bool()>& stop);

} // namespace abbe

// Pilots by which camera paths are guided.
#pragma once

#include "caustics/shared/kernel_jobs.h"
#include "guiding/path_guide.h"
#include "transport/roulette.h"

#include <functional>
#include <memory>

namespace abbe {

// Of a plan, for people.
struct GuideFindings {
    enum class Verdict : std::uint8_t {
        undecided,      // nothing was looked at yet, or the render was stopped before
        off,            // `guiding off`
        otherTechnique, // another choice of `render` is at odds with it
        media,          // paths are long in them
        noPilot,        // the render is too short for one
        noGain,         // surfaces know well enough where to go
        used
    };
    Verdict verdict = Verdict::undecided;
    double gain = 0; // what of the variance of samples it takes away, as far as pilots tell; 0: unknown
    std::size_t regions = 0, guided = 0, bytes = 0;
    bool distances = false; // in media, too
};

struct GuidePlan {
    std::unique_ptr<const PathGuide> guide; // null: paths go as surfaces scatter
    GuideFindings findings;
    std::uint64_t rays = 0; // that the pilots took
};

// Camera paths of the context go by the guide from here on; null: by none. It outlives the context.
void guideBy(const PathGuide*, PathContext&);

// Sizes of pilots. A frame is seen through at most 128 × 128 of its pixels, as PilotFilm chooses them; of the largest
// half a GiB is in use while it is learnt from them.
class GuideSize {
  public:
    static constexpr int kMost = 3;
    // Of each pixel that is looked at.
    static std::uint32_t samples(int size) { return 4u << size; }
    // The largest whose pilots take no more than so many paths; 0: none.
    static int within(PixelBounds frame, double paths);
};

// First a glance at an eighth of the pixels, where that are enough: most scenes have nothing to guide and show it. Then
// rounds of pilots, each guided by what those before have found and with up to seven times as many samples as all of
// them [Mueller2017]. After the first, which tells whether any is worth it, nothing more is done where surfaces know
// well enough and distances in media are as well left to chance. Depends on
// nothing. Requires 0 < size <= GuideSize::kMost, and a context with the plans for caustics, if any. `shown`: what
// pixels show.
GuidePlan planGuide(const PathContext&, TileFunction, const Film&, const RouletteReference& shown, int size,
                    const std::function<bool()>& stop);

} // namespace abbe

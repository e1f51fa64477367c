// One render that goes on from rung to rung.
#pragma once

#include "film/pixel_film.h"
#include "render/render_state.h"
#include "study/reference_pair.h"
#include "study/seed_runs.h"
#include "study/study_plan.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>

namespace abbe {

// The image after so many samples, and what it took; its errors are not known yet.
struct LadderRung {
    std::uint32_t samples = 0; // per pixel
    StudyImage image;
    RungRun cost;
};

// A variant with one seed. Rungs are one progressive render: a ladder takes as long as its last rung. Stratified
// numbers alone begin anew at each, because the strata are as many as the samples; a rung then costs what it takes by
// itself.
class LadderRender {
  public:
    // The subject outlives it. `stop` may be null.
    LadderRender(const StudySubject&, const StudyVariant&, std::uint64_t seed, const std::atomic<bool>* stop);

    // Goes on to so many samples of each replicate, not fewer than before. `progress` hears what fraction of this step
    // is done. Nothing if it was stopped on the way.
    std::optional<LadderRung> advance(std::uint32_t samplesPerReplicate,
                                      const std::function<void(double)>& progress = {});

    // Samples that were dropped because something in them was not finite or negative.
    std::uint64_t dropped() const { return dropped_; }

  private:
    void begin();
    void account(const RenderStatistics&, double seconds);
    StudyImage denoised(ResolvedImage&) const;

    const StudySubject& subject_;
    const StudyVariant& variant_;
    RenderSettings settings_;
    const std::atomic<bool>* stop_;
    std::unique_ptr<const Integrator> integrator_;
    std::optional<PixelFilm> film_;
    std::optional<RenderState> state_;
    RungRun cost_;                 // of rendering, so far
    std::uint64_t firstPilot_ = 0; // rays of the look ahead
    double pilotCoreSeconds_ = 0;
    std::uint64_t dropped_ = 0;
};

} // namespace abbe

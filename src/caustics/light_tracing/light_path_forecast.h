// How noisy a picture will be with light paths, predicted by a pilot of a few light paths and some pixels.
#pragma once

#include "caustics/light_tracing/camera_look.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/shared/noise_measure.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace abbe {

// Where light paths go, for people to read. Those of the same light and target by name added up, the largest shares
// first, LightPathFindings::kShares at most: the last one stands for all that are left. Pairs that nothing is sent to
// are left out.
std::vector<LightPathShare> largestShares(const std::vector<LightPathShare>&);

// By samples of light paths of density q ∫ f² / (p + s q) is predicted for any number s of them beside one camera path
// of density p: weighed by the balance heuristic, that is the second moment of a sample of all pixels [Veach1997, sec.
// 9.2]. No camera path has to find the light first.
class LightPathForecast {
  public:
    LightPathForecast(std::span<const LightDeposit>, PixelBounds frame, const NoiseMeasure&);

    // Second moment of what camera paths find now and then, far brighter than its pixel: what light paths are for.
    double fireflies() const;
    // Variance of what light paths can bring, with `share` of them for each camera path; `seen` is what camera paths
    // were seen to have of it without them, and perhaps with some. Of light paths the second moment is the variance:
    // they are many for a pixel and bring little each. They count as independent, although they are stratified over the
    // picture as a whole: pixels have little of that unless lights are small.
    double variance(double share, const CameraNoise& seen) const;

  private:
    struct Term {
        double u2 = 0;  // squared relative luminance that a light path brings to a pixel, times how many it stands for
        double rho = 0; // as LightDeposit
        double brightness = 0; // as NoiseMeasure::brightness
        bool isFirefly() const { return NoiseMeasure::isFirefly(brightness, rho); }
        double ofCamera(double share) const { return u2 * rho / square(rho + share); }
        double ofLight(double share) const { return u2 * share / square(rho + share); }
    };
    // Of terms that were seen.
    struct Seen {
        double alone = 0, beside = 0; // second moments without light paths and with them
        void add(const Term& t, double share) {
            alone += t.ofCamera(0);
            beside += t.ofCamera(share);
        }
        double left() const { return alone > 0 ? beside / alone : 0; }
    };
    // Of camera paths with `share` light paths for each.
    struct CameraPart {
        double missed = 0; // second moment of fireflies that nobody saw
        Seen loud, quiet;  // fireflies that were seen, and the rest
    };
    CameraPart cameraPart(double share, const CameraNoise& seen) const;
    void limitOutliers();

    std::vector<Term> terms_; // the brightest first
};

} // namespace abbe

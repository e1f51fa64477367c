// How noisy a picture will be with light paths, foretold from a few of them.
#pragma once

#include "integrators/camera_pilot.h"
#include "integrators/light_deposit.h"
#include "integrators/noise_measure.h"

#include <span>
#include <vector>

namespace abbe {

// By samples of light paths of density q ∫ f² / (p + s q) is foretold for any number s of them beside one camera path
// of density p: weighed by the balance heuristic, that is the second moment of a sample of all pixels [Veach1997, sec.
// 9.2]. No camera path has to find the light first.
class LightPathForecast {
  public:
    LightPathForecast(std::span<const LightDeposit>, PixelBounds frame, const NoiseMeasure&);

    // Second moment of what camera paths find now and then, far brighter than its pixel: what light paths are for.
    double sparks() const;
    // Variance of what light paths can bring, with `share` of them for each camera path; camera paths were seen to have
    // `alone` of it without them. Of light paths the second moment is the variance: they are many for a pixel and bring
    // little each. They count as independent, although they are stratified over the picture as a whole: pixels have
    // little of that unless lamps are small.
    double variance(double share, const CameraVariance& alone) const;

  private:
    struct Term {
        double u2 = 0;  // squared relative luminance that a light path brings to a pixel, times how many it stands for
        double rho = 0; // as LightDeposit
        double spark = 0; // relative luminance of a camera path that finds the same
        double ofCamera(double share) const { return u2 * rho / square(rho + share); }
        double ofLight(double share) const { return u2 * share / square(rho + share); }
    };
    void limitOutliers();

    std::vector<Term> terms_; // the brightest sparks first
};

} // namespace abbe

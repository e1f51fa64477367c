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
    // The measure outlives this.
    LightPathForecast(std::span<const LightDeposit>, PixelBounds frame, const NoiseMeasure&);

    // Relative variance of what light paths can bring, of one sample of all pixels with `share` light paths for each
    // camera path, all of them independent.
    double variance(double share) const { return camera(share) + light(share); }
    // The same with camera paths as stratified as `alone` they were seen to be. Light paths still count as independent:
    // they are stratified over all the picture, of which a pixel sees little unless lamps are small.
    double variance(double share, const StratifiedVariance& alone) const;
    // The second moment of one deposit by itself.
    double secondMoment(const LightDeposit&, double share) const;

  private:
    struct Term {
        std::uint32_t cell = 0;
        double u = 0, u2 = 0; // relative luminance, and its square times how many paths it stands for
        double rho = 0;
    };
    double camera(double share) const;
    double cameraSecondMoment(double share) const;
    double light(double share) const;
    double squaredMean(double share) const;

    const NoiseMeasure& measure_;
    double pixels_;
    std::vector<Term> terms_;
};

} // namespace abbe

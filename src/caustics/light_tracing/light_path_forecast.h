// How noisy a picture will be with light paths, predicted by a pilot of a few light paths and some pixels.
#pragma once

#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/shared/kernel_jobs.h"
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

// What camera paths bring, relative and in the mean over the frame as NoiseMeasure has it.
struct CameraVariance {
    static constexpr std::uint32_t kMany = 64; // samples of a pixel: a power of two, and the square of another

    double secondMoment = 0, variance = 0; // of one sample
    double ofMeans = 0;                    // variance of the mean of kMany samples of one pixel, times their number

    // The same of 512 samples, for which renders are planned, whatever their number is. Samples of a pixel are
    // stratified, and what that takes off the variance grows by a power of their number.
    double planned() const { return variance > 0 ? ofMeans * std::min(1.0, std::sqrt(ofMeans / variance)) : 0; }
};

struct CameraNoise {
    CameraVariance shared; // the light that light paths could bring, as camera paths find it without them
    CameraVariance quiet;  // the same without what is brighter than NoiseMeasure::kBright pixels
    CameraVariance rest;   // everything else
    double rays = 0;       // of a camera path, without the cost of weights
    std::uint64_t pilotRays = 0;

    // The mean over pixels.
    static CameraNoise of(std::span<const CameraNoise> pixels);
};

// A look at the pixels of an even grid. `plan` says what light paths could bring; `context` has none. Depends on the
// frame and the seed of the context alone.
std::vector<CameraNoise> cameraNoise(const PathContext&, TileFunction traced, const RouletteReference&,
                                     const LightPathPlan&, const NoiseMeasure&);

// By samples of light paths of density q ∫ f² / (p + s q) is predicted for any number s of them beside one camera path
// of density p: weighed by the balance heuristic, that is the second moment of a sample of all pixels [Veach1997, sec.
// 9.2]. No camera path has to find the light first.
class LightPathForecast {
  public:
    LightPathForecast(std::span<const LightDeposit>, PixelBounds frame, const NoiseMeasure&);

    // Second moment of what camera paths find now and then, far brighter than its pixel: what light paths are for.
    double fireflies() const;
    // Variance of what light paths can bring, with `share` of them for each camera path; `seen` is what camera paths
    // were seen to have of it without them. Of light paths the second moment is the variance: they are many for a pixel
    // and bring little each. They count as independent, although they are stratified over the picture as a whole:
    // pixels have little of that unless lights are small.
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
    void limitOutliers();

    std::vector<Term> terms_; // the brightest first
};

} // namespace abbe

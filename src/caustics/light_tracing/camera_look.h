// A look at what a few pixels show, by camera paths alone and beside light paths: the noise that light paths are to
// take away.
#pragma once

#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/shared/kernel_jobs.h"
#include "caustics/shared/noise_measure.h"
#include "caustics/shared/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

// What camera paths bring, relative and in the mean over the frame as NoiseMeasure has it.
struct CameraVariance {
    static constexpr std::uint32_t kMany = 64; // samples of a pixel: a power of two, and the square of another

    double secondMoment = 0; // of one sample
    // Of 512 samples of a pixel, for which renders are planned, whatever their number is: variance of their mean, times
    // their number.
    double planned = 0;

    // `variance`: of one sample; `ofMeans`: as `planned`, of kMany samples. Samples of a pixel are stratified, and what
    // that takes off the variance grows by a power of their number. That is so of each pixel by itself: where few
    // samples bring most of the light, stratification takes nothing away, however much it takes elsewhere.
    static CameraVariance ofPixel(double secondMoment, double variance, double ofMeans) {
        const double more = variance > 0 ? std::min(1.0, std::sqrt(ofMeans / variance)) : 0;
        return {secondMoment, ofMeans * more};
    }
};

struct CameraNoise {
    struct Found {
        CameraVariance all;
        CameraVariance quiet; // without what is brighter alone than NoiseMeasure::kBright pixels
    };
    Found alone;            // the light that light paths could bring, as camera paths find it without them
    Found beside;           // the same, weighed beside so many light paths for each;
    double besideShare = 0; // 0: nobody looked
    CameraVariance rest;    // everything else
    double rays = 0;        // of a camera path, without the cost of weights
    std::uint64_t pilotRays = 0;

    // The mean over pixels.
    static CameraNoise of(std::span<const CameraNoise> pixels);
};

// At the pixels of an even grid. Depends on the frame and the seed of the context alone; what it is given outlives it.
class CameraLook {
  public:
    // `plan` says what light paths could bring; `context` has none.
    CameraLook(const PathContext&, TileFunction, const RouletteReference&, const LightPathPlan&, const NoiseMeasure&);

    std::span<const CameraNoise> pixels() const { return pixels_; }
    // Once more, beside light paths of the plan, `share` for each camera path.
    void lookBeside(double share);

  private:
    static constexpr int kReplicates = 2;
    using Samples = std::array<std::array<double, CameraVariance::kMany>, kReplicates>;
    struct Probe {
        Samples y{};
        std::uint64_t rays = 0;
    };
    struct Pixel {
        PixelBounds bounds;
        double weight = 0;
        Samples alone{}, rest{};
    };

    Probe probe(const PathContext&, PixelBounds pixel) const;
    void limitOutliers();
    static Samples difference(Samples, const Samples&);
    static double meanOf(const Samples&);
    static CameraVariance varianceOf(const Samples&, double weight);
    static CameraNoise::Found found(const Samples&, const Pixel&);

    const PathContext& context_;
    TileFunction traced_;
    const RouletteReference& roulette_;
    const LightPathPlan& plan_;
    std::vector<Pixel> looks_;
    std::vector<CameraNoise> pixels_;
};

} // namespace abbe

// Rounds of merging that are looked at before a render.
#pragma once

#include "caustics/shared/kernel_jobs.h"
#include "caustics/shared/noise_measure.h"

#include <functional>
#include <unordered_map>
#include <vector>

namespace abbe {

// Some rounds with few light paths, gathered by an even part of the pixels.
class MergePilot {
  public:
    // What one light adds to one pixel in one round; luminance.
    struct Pixel {
        std::uint32_t light = 0; // place in the scene
        int x = 0, y = 0;
        double sum = 0, squares = 0; // of what its photons bring, and of the squares
        double camera = 0;           // Σ of what a photon brings times the sample of a camera path that finds the same
        double unseen = 0;           // of the sum, by photons that no camera path finds
        std::uint64_t rays = 0;      // of the camera path
    };
    struct Heard {
        std::vector<Pixel> pixels;
        std::vector<LightStart> starts;
        std::vector<LightDeposit> deposits;    // whose squares add up as those of the photons do
        double looks = 0;                      // pixels times rounds
        double each = 0;                       // pixels of the frame for each of those
        double gatherRays = 0, photonRays = 0; // of a pixel of a round, and of a light path
        double photons = 0;                    // that a light path leaves
        std::uint64_t rays = 0;

        // As deposits that add up to the light itself.
        std::vector<LightDeposit> shown() const;
    };

    MergePilot(const PathContext& context, const LightPathKernel& kernel, const std::function<bool()>& stop);
    // Light paths of a round.
    std::uint32_t photons() const { return photons_; }
    // Radius of its disks over that of a render: a pilot with few light paths finds as many photons in a disk as one
    // with many does, or it would know of the images of caustics by luck alone.
    float wider() const { return wider_; }
    // Depends on the scene, the frame, the settings of the context and the key alone, unless `stop` cuts it short.
    Heard listen(const MergePlan&, std::uint64_t key) const;

  private:
    class Listener;

    const PathContext& context_;
    const LightPathKernel& kernel_;
    const std::function<bool()>& stop_;
    std::uint32_t photons_;
    float wider_;
    int step_;
    std::unordered_map<const Light*, std::uint32_t> numbers_;
};

} // namespace abbe

#include "integrators/camera_pilot.h"

#include "base/parallel.h"
#include "base/work.h"
#include "integrators/pilot_pixel.h"
#include "integrators/pilot_size.h"

#include <vector>

namespace abbe {

namespace {

constexpr int kCells = 12, kLeastCells = 3; // of a row
constexpr int kReplicates = 2;

using Samples = std::array<std::array<double, CameraVariance::kMany>, kReplicates>;

struct Probe {
    Samples y{};
    std::uint64_t rays = 0;
};

// One call for each sample: a film is told sums alone.
Probe probe(const PathContext& context, TileFunction render, const RouletteReference& roulette, PixelBounds pixel) {
    Probe result;
    PilotPixel film(pixel, kReplicates);
    for (std::uint32_t i = 0; i < CameraVariance::kMany; ++i) {
        const TileResult r = render(context, film, {pixel, i, i + 1, &roulette});
        for (int k = 0; k < kReplicates; ++k) result.y[static_cast<std::size_t>(k)][i] = film.luminance(k);
        result.rays += r.counters.vertices + r.counters.shadowRays;
    }
    return result;
}

CameraVariance varianceOf(const Samples& samples, double weight) {
    constexpr double kMany = CameraVariance::kMany;
    std::array<double, kReplicates> means{};
    double mean = 0;
    for (std::size_t k = 0; k < means.size(); ++k) {
        for (const double v : samples[k]) means[k] += v / kMany;
        mean += means[k] / kReplicates;
    }
    CameraVariance result;
    for (std::size_t k = 0; k < means.size(); ++k) {
        for (const double v : samples[k]) {
            result.secondMoment += weight * square(v) / (kReplicates * kMany);
            result.variance += weight * square(v - mean) / (kReplicates * kMany - 1);
        }
        result.ofMeans += weight * kMany * square(means[k] - mean) / (kReplicates - 1);
    }
    return result;
}

void add(CameraVariance& to, const CameraVariance& v, double share) {
    to.secondMoment += v.secondMoment * share;
    to.variance += v.variance * share;
    to.ofMeans += v.ofMeans * share;
}

} // namespace

CameraNoise cameraNoise(const PathContext& context, TileFunction render, const RouletteReference& roulette,
                        const LightPathPlan& plan, const NoiseMeasure& measure) {
    const PilotPixel::Grid grid(context.scene.frame, PilotSize(context.settings).side(kCells, kLeastCells));
    LightPathPlan all = plan; // leaves to light paths what they can bring
    all.alone = true;
    PathContext without = context;
    without.traced = &all;
    std::vector<CameraNoise> pixels(grid.size());
    parallelFor(pixels.size(), [&](std::size_t i) {
        const PixelBounds pixel = grid.pixel(i);
        addWorkFlag(WorkFlag::pilot);
        Probe found = probe(context, render, roulette, pixel);
        const Probe rest = probe(without, render, roulette, pixel);
        removeWorkFlag(WorkFlag::pilot);
        // The same paths, so that what one of them has more is what light paths could bring.
        for (std::size_t k = 0; k < found.y.size(); ++k)
            for (std::size_t s = 0; s < found.y[k].size(); ++s) found.y[k][s] -= rest.y[k][s];
        const double weight = measure.weight(pixel.x0, pixel.y0);
        pixels[i] = {varianceOf(found.y, weight), varianceOf(rest.y, weight),
                     static_cast<double>(found.rays) / (kReplicates * CameraVariance::kMany), found.rays + rest.rays};
    });
    CameraNoise result;
    const double share = 1 / static_cast<double>(pixels.size());
    for (const CameraNoise& p : pixels) {
        add(result.shared, p.shared, share);
        add(result.rest, p.rest, share);
        result.rays += p.rays * share;
        result.pilotRays += p.pilotRays;
    }
    return result;
}

} // namespace abbe

#include "caustics/light_tracing/camera_look.h"

#include "base/parallel.h"
#include "base/work.h"
#include "render/scene.h"

#include <numeric>

namespace abbe {

namespace {

constexpr int kCells = 12, kLeastCells = 3; // of a row

void add(CameraVariance& to, const CameraVariance& v, double share) {
    to.secondMoment += v.secondMoment * share;
    to.planned += v.planned * share;
}

void add(CameraNoise::Found& to, const CameraNoise::Found& v, double share) {
    add(to.all, v.all, share);
    add(to.quiet, v.quiet, share);
}

} // namespace

CameraNoise CameraNoise::of(std::span<const CameraNoise> pixels) {
    CameraNoise result;
    const double share = 1 / static_cast<double>(pixels.size());
    for (const CameraNoise& p : pixels) {
        add(result.alone, p.alone, share);
        add(result.beside, p.beside, share);
        add(result.rest, p.rest, share);
        result.besideShare += p.besideShare * share;
        result.rays += p.rays * share;
        result.pilotRays += p.pilotRays;
    }
    return result;
}

CameraLook::CameraLook(const PathContext& context, TileFunction traced, const RouletteReference& roulette,
                       const LightPathPlan& plan, const NoiseMeasure& measure)
    : context_(context), traced_(traced), roulette_(roulette), plan_(plan) {
    const PilotPixel::Grid grid(context.scene.frame, PilotSize(context.settings).side(kCells, kLeastCells));
    LightPathPlan all = plan; // leaves to light paths what they can bring
    all.alone = true;
    PathContext without = context;
    without.lightPaths = &all;
    looks_.resize(grid.size());
    pixels_.resize(grid.size());
    parallelFor(grid.size(), [&](std::size_t i) {
        Pixel& look = looks_[i];
        look.bounds = grid.pixel(i);
        const Probe whole = probe(context, look.bounds), rest = probe(without, look.bounds);
        look.weight = measure.weight(look.bounds.x0, look.bounds.y0, meanOf(whole.y));
        look.rest = rest.y;
        // The same paths, so that what one of them has more is what light paths could bring.
        look.alone = difference(whole.y, rest.y);
        pixels_[i].alone = found(look.alone, look);
        pixels_[i].rays = static_cast<double>(whole.rays) / (kReplicates * CameraVariance::kMany);
        pixels_[i].pilotRays = whole.rays + rest.rays;
    });
    limitOutliers();
}

void CameraLook::lookBeside(double share) {
    LightPathPlan plan = plan_;
    plan.paths = LightPathPlan::pathsFor(share, static_cast<double>(context_.scene.frame.area()));
    PathContext beside = context_;
    beside.lightPaths = &plan;
    parallelFor(looks_.size(), [&](std::size_t i) {
        const Pixel& look = looks_[i];
        const Probe both = probe(beside, look.bounds);
        pixels_[i].beside = found(difference(both.y, look.rest), look);
        pixels_[i].besideShare = share;
        pixels_[i].pilotRays += both.rays;
    });
}

// One call for each sample: a film gets sums alone.
CameraLook::Probe CameraLook::probe(const PathContext& context, PixelBounds pixel) const {
    Probe result;
    PilotPixel film(pixel, kReplicates);
    addWorkFlag(WorkFlag::pilot);
    for (std::uint32_t i = 0; i < CameraVariance::kMany; ++i) {
        const TileResult r = traced_(context, film, {pixel, i, i + 1, &roulette_});
        for (int k = 0; k < kReplicates; ++k) result.y[static_cast<std::size_t>(k)][i] = film.luminance(k);
        result.rays += r.counters.vertices + r.counters.shadowRays;
    }
    removeWorkFlag(WorkFlag::pilot);
    return result;
}

CameraLook::Samples CameraLook::difference(Samples samples, const Samples& others) {
    for (std::size_t k = 0; k < samples.size(); ++k)
        for (std::size_t s = 0; s < samples[k].size(); ++s) samples[k][s] -= others[k][s];
    return samples;
}

double CameraLook::meanOf(const Samples& samples) {
    double sum = 0;
    for (const auto& replicate : samples) sum += std::accumulate(replicate.begin(), replicate.end(), 0.0);
    return sum / (kReplicates * CameraVariance::kMany);
}

CameraVariance CameraLook::varianceOf(const Samples& samples, double weight) {
    constexpr double kMany = CameraVariance::kMany;
    const double mean = meanOf(samples);
    std::array<double, kReplicates> means{};
    double secondMoment = 0, variance = 0, ofMeans = 0;
    for (std::size_t k = 0; k < means.size(); ++k) {
        for (const double v : samples[k]) {
            means[k] += v / kMany;
            secondMoment += square(v) / (kReplicates * kMany);
            variance += square(v - mean) / (kReplicates * kMany - 1);
        }
        ofMeans += kMany * square(means[k] - mean) / (kReplicates - 1);
    }
    return CameraVariance::ofPixel(weight * secondMoment, weight * variance, weight * ofMeans);
}

CameraNoise::Found CameraLook::found(const Samples& samples, const Pixel& look) {
    const double most = NoiseMeasure::kBright / std::sqrt(look.weight);
    Samples quiet = samples;
    for (std::size_t k = 0; k < quiet.size(); ++k)
        for (std::size_t s = 0; s < quiet[k].size(); ++s)
            if (look.alone[k][s] > most) quiet[k][s] = 0;
    return {varianceOf(samples, look.weight), varianceOf(quiet, look.weight)};
}

// Of the rest of all pixels, over what they show: the two brightest count as the third. A firefly that a look happens
// to meet would be all of the noise, beside which nothing is worth a light path; and another technique may have it.
void CameraLook::limitOutliers() {
    constexpr std::size_t kFew = 2;
    std::vector<double> all;
    for (const Pixel& look : looks_)
        for (const auto& replicate : look.rest)
            for (const double v : replicate) all.push_back(v * std::sqrt(look.weight));
    std::ranges::nth_element(all, all.begin() + kFew, std::ranges::greater());
    for (std::size_t i = 0; i < looks_.size(); ++i) {
        Samples rest = looks_[i].rest;
        for (auto& replicate : rest)
            for (double& v : replicate) v = std::min(v, all[kFew] / std::sqrt(looks_[i].weight));
        pixels_[i].rest = varianceOf(rest, looks_[i].weight);
    }
}

} // namespace abbe

#include "caustics/light_tracing/light_path_forecast.h"

#include "base/parallel.h"
#include "base/work.h"
#include "caustics/shared/pilot.h"
#include "render/scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace abbe {

namespace {

void add(LightPathShare& to, const LightPathShare& s) {
    to.share += s.share;
    to.before += s.before;
    to.after += s.after;
}

// Those of the same names, as of a light that is placed many times.
std::vector<LightPathShare> byName(const std::vector<LightPathShare>& shares) {
    std::vector<LightPathShare> result;
    std::map<std::pair<std::string, std::string>, std::size_t> places;
    for (const LightPathShare& s : shares) {
        const auto [place, isNew] = places.emplace(std::pair(s.light, s.target), result.size());
        if (isNew)
            result.push_back(s);
        else
            add(result[place->second], s);
    }
    return result;
}

} // namespace

std::vector<LightPathShare> largestShares(const std::vector<LightPathShare>& all) {
    constexpr std::size_t kMostShares = LightPathFindings::kShares;
    std::vector<LightPathShare> shares = byName(all);
    std::erase_if(shares, [](const LightPathShare& s) { return !(s.share > 0); });
    std::ranges::stable_sort(shares, std::ranges::greater(), &LightPathShare::share);
    if (shares.size() <= kMostShares) return shares;
    LightPathShare others;
    for (std::size_t i = kMostShares - 1; i < shares.size(); ++i) add(others, shares[i]);
    shares.resize(kMostShares - 1);
    shares.push_back(others);
    return shares;
}

namespace {

constexpr int kCells = 12, kLeastCells = 3; // of a row
constexpr int kReplicates = 2;

using Samples = std::array<std::array<double, CameraVariance::kMany>, kReplicates>;

struct Probe {
    Samples y{};
    std::uint64_t rays = 0;
};

// One call for each sample: a film gets sums alone.
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

// Without fireflies.
Samples quietOf(Samples samples, double weight) {
    const double most = NoiseMeasure::kBright / std::sqrt(weight);
    for (auto& replicate : samples)
        for (double& v : replicate)
            if (v > most) v = 0;
    return samples;
}

// Of all pixels, over what they show: the two brightest count as the third. A firefly that a look happens to meet
// would be all of the noise, beside which nothing is worth a light path; and another technique may have it.
void limitOutliers(std::span<Samples> pixels, std::span<const double> weights) {
    constexpr std::size_t kFew = 2;
    std::vector<double> all;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (const auto& replicate : pixels[i])
            for (const double v : replicate) all.push_back(v * std::sqrt(weights[i]));
    std::ranges::nth_element(all, all.begin() + kFew, std::ranges::greater());
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (auto& replicate : pixels[i])
            for (double& v : replicate) v = std::min(v, all[kFew] / std::sqrt(weights[i]));
}

void add(CameraVariance& to, const CameraVariance& v, double share) {
    to.secondMoment += v.secondMoment * share;
    to.variance += v.variance * share;
    to.ofMeans += v.ofMeans * share;
}

} // namespace

CameraNoise CameraNoise::of(std::span<const CameraNoise> pixels) {
    CameraNoise result;
    const double share = 1 / static_cast<double>(pixels.size());
    for (const CameraNoise& p : pixels) {
        add(result.shared, p.shared, share);
        add(result.quiet, p.quiet, share);
        add(result.rest, p.rest, share);
        result.rays += p.rays * share;
        result.pilotRays += p.pilotRays;
    }
    return result;
}

std::vector<CameraNoise> cameraNoise(const PathContext& context, TileFunction render, const RouletteReference& roulette,
                                     const LightPathPlan& plan, const NoiseMeasure& measure) {
    const PilotPixel::Grid grid(context.scene.frame, PilotSize(context.settings).side(kCells, kLeastCells));
    LightPathPlan all = plan; // leaves to light paths what they can bring
    all.alone = true;
    PathContext without = context;
    without.lightPaths = &all;
    std::vector<CameraNoise> pixels(grid.size());
    std::vector<Samples> rests(grid.size());
    std::vector<double> weights(grid.size());
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
        rests[i] = rest.y;
        weights[i] = weight;
        pixels[i] = {varianceOf(found.y, weight),
                     varianceOf(quietOf(found.y, weight), weight),
                     {},
                     static_cast<double>(found.rays) / (kReplicates * CameraVariance::kMany),
                     found.rays + rest.rays};
    });
    limitOutliers(rests, weights);
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i].rest = varianceOf(rests[i], weights[i]);
    return pixels;
}

LightPathForecast::LightPathForecast(std::span<const LightDeposit> deposits, PixelBounds frame,
                                     const NoiseMeasure& measure) {
    const auto pixels = static_cast<double>(frame.area());
    terms_.reserve(deposits.size());
    for (const LightDeposit& d : deposits) {
        const double rho = std::max(d.rho, 1e-12); // no camera path may find it
        const double u = d.luminance * std::sqrt(measure.weight(d.x, d.y));
        terms_.push_back({u * u * d.stands / pixels, rho, u / rho});
    }
    limitOutliers();
    std::ranges::stable_sort(terms_, std::ranges::greater(), &Term::brightness);
}

// A few deposits that camera paths would hit once in millions would say all of a second moment, and next to nothing of
// what renders show: the largest count as the ninth.
void LightPathForecast::limitOutliers() {
    constexpr std::size_t kFew = 8;
    if (terms_.size() <= kFew) return;
    const auto largest = [](const Term& a, const Term& b) { return a.ofCamera(0) > b.ofCamera(0); };
    const auto ninth = terms_.begin() + kFew;
    std::ranges::nth_element(terms_, ninth, largest);
    const double most = ninth->ofCamera(0);
    for (auto t = terms_.begin(); t != ninth; ++t) {
        t->brightness *= most * t->rho / t->u2;
        t->rho = t->u2 / most;
    }
}

double LightPathForecast::fireflies() const {
    double sum = 0;
    for (const Term& t : terms_)
        if (t.isFirefly()) sum += t.ofCamera(0);
    return sum;
}

// The second moment of fireflies that light paths tell and a look at some pixels has not seen is that of the brightest,
// which are the rarest; a mean of samples has all of it, stratified or not. Those that were seen are as noisy as they
// were seen to be. So is the rest, which is far less than its second moment: most of it is light that camera paths find
// with next to no noise. The two stay apart, or one firefly that a look happens to see would count as noise that no
// light path takes away.
double LightPathForecast::variance(double share, const CameraNoise& camera) const {
    const double seenLoud = std::max(0.0, camera.shared.planned() - camera.quiet.planned());
    const double loud = std::min(seenLoud, fireflies()); // no variance is above the second moment
    double missed = fireflies() - (camera.shared.secondMoment - camera.quiet.secondMoment);
    double variance = 0;
    Seen fireflies, quiet;
    for (const Term& t : terms_) {
        variance += t.ofLight(share);
        if (!t.isFirefly()) {
            quiet.add(t, share);
            continue;
        }
        if (missed > 0)
            variance += t.ofCamera(share);
        else
            fireflies.add(t, share);
        missed -= t.ofCamera(0);
    }
    return variance + fireflies.left() * loud + quiet.left() * camera.quiet.planned();
}

} // namespace abbe

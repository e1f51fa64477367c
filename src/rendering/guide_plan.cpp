#include "rendering/guide_plan.h"

#include "base/memory_limit.h"
#include "base/parallel.h"
#include "base/work.h"
#include "math/hash.h"
#include "render/scene.h"
#include "rendering/guide_recorder.h"
#include "transport/roulette.h"

#include <algorithm>
#include <fmt/format.h>
#include <new>
#include <numeric>

namespace abbe {

namespace {

constexpr std::uint64_t kGuide = 0x6775696465;    // "guide"
constexpr std::uint64_t kGlance = 0x676c616e6365; // "glance"
constexpr std::uint32_t kFirstRound = 2;          // samples of each pixel
// Before it, of every so many-th pixel as long as that leaves enough of them; with few vertices regions are small.
constexpr int kGlanceStride = 8, kGlancePixels = 2000;
constexpr std::size_t kGlanceRegion = 1000;
// Pilots' paths go on while they carry this part of the light: what roulette multiplies is hard to learn from.
constexpr float kPatience = 15;
constexpr std::uint32_t kGrowth = 7; // of the number of samples, from round to round at most
// Of the variance of samples, what has to go for guiding to be worth what it takes, and for more pilots to be worth it.
constexpr double kWorthGuiding = 0.5, kWorthPilots = 0.15;
// What guided distances in media may leave of it to be worth what they take.
constexpr double kWorthDistances = 0.53;

// What a vertex takes while a guide is learnt from it, in bytes: once as a row has found it, once among all, and its
// places in cells and regions.
constexpr double kBytesOfVertex = 2.2 * sizeof(PilotVertex);

class GuidePilots {
  public:
    GuidePilots(const PathContext& context, TileFunction render, const Film& film, const RouletteReference& shown,
                const std::function<bool()>& stop)
        : context_(context), render_(render), film_(film), shown_(shown), stop_(stop) {}

    GuidePlan run(int size) {
        const bool always = context_.settings.technique.guiding == Technique::Guiding::always;
        if (!always && !glance()) {
            if (!stop_()) plan_.findings.verdict = GuideFindings::Verdict::noGain;
            return std::move(plan_);
        }
        const std::uint32_t all = GuideSize::samples(size);
        for (std::uint32_t samples = 0, next = kFirstRound; samples < all;) {
            round(next, 1, combine64(combine64(context_.settings.seed, kGuide), paths_));
            samples += next;
            if (stop_()) return {nullptr, {}, plan_.rays};
            if (!(radiance_ > 0)) break; // all is dark
            const bool first = !guide_;
            if (first)
                variance_ = meanVariance(variances_);
            else
                distancesLeave_ = leftByDistances();
            const double gain = learn(kRegionVertices);
            const double left = std::max(0.0, 1 - gain / variance_); // by directions
            plan_.findings.gain = 1 - left * (distancesPay() ? distancesLeave_ : 1);
            const bool promises = always || plan_.findings.gain >= kWorthPilots;
            if (!promises && !(first && guide_->cache())) break; // distances are not tried yet
            next = std::min(promises ? kGrowth * samples : kFirstRound, all - samples);
        }
        if (guide_ && !always && !distancesPay()) guide_->leaveDistances();
        finish(guide_ && (always || plan_.findings.gain >= kWorthGuiding));
        return std::move(plan_);
    }

  private:
    // Whether there may be anything to gain, by few pixels: where there is none in any region of theirs, all pixels
    // would not find enough of it for another round. Nothing is kept of it.
    bool glance() {
        const PilotFilm pixels(frame(), 0);
        const int stride = std::min(kGlanceStride, pixels.columns() * pixels.rows() / kGlancePixels);
        if (stride < 2) return true;
        const std::uint64_t seed = combine64(context_.settings.seed, kGlance);
        round(kFirstRound, stride, seed);
        bool gains = true; // so far all is dark
        if (radiance_ > 0 && !stop_()) gains = learn(kGlanceRegion) > 0 || distancesGain(stride, seed);
        guide_.reset();
        vertices_.clear();
        radiance_ = 0;
        paths_ = 0;
        return gains && !stop_();
    }

    // By the same few pixels, with what is known of them.
    bool distancesGain(int stride, std::uint64_t seed) {
        if (!guide_->cache()) return false;
        round(kFirstRound, stride, combine64(seed, paths_));
        return leftByDistances() < kWorthDistances;
    }

    // Makes a guide of all vertices; returns what directions take of the variance of a sample.
    double learn(std::size_t regionVertices) {
        const auto paths = static_cast<double>(paths_);
        TrainedGuide trained = trainGuide(vertices_, radiance_ / paths, regionVertices);
        guide_ = std::make_unique<PathGuide>(std::move(trained.guide));
        return trained.gain / paths;
    }

    void finish(bool used) {
        GuideFindings& f = plan_.findings;
        f.verdict = used ? GuideFindings::Verdict::used : GuideFindings::Verdict::noGain;
        if (!used) return;
        f.regions = guide_->regions().size();
        f.guided = static_cast<std::size_t>(
            std::ranges::count_if(guide_->regions(), [](const PathGuide::Region& r) { return r.guided > 0; }));
        f.distances = guide_->cache() != nullptr;
        f.bytes = guide_->bytes();
        plan_.guide = std::move(guide_);
    }

    PixelBounds frame() const { return context_.scene.frame.area() > 0 ? context_.scene.frame : film_.bounds(); }

    bool distancesPay() const { return distancesLeave_ < kWorthDistances; }
    // Of the variance of samples of the last round, guided distances against those that are left to chance.
    double leftByDistances() {
        return guide_->cache() ? meanVariance(variances_) / meanVariance(variancesByChance_) : 1;
    }

    // Of one sample, in the mean over the pixels without the hundredth of them that has the most: few samples say
    // little about rare bright ones.
    static double meanVariance(std::vector<double>& pixels) {
        if (pixels.empty()) return 1e-12; // the render is to end
        const auto end = pixels.begin() + static_cast<std::ptrdiff_t>(pixels.size() - pixels.size() / 100);
        std::nth_element(pixels.begin(), end - 1, pixels.end());
        return std::accumulate(pixels.begin(), end, 1e-12) / static_cast<double>(pixels.size());
    }

    // As many vertices each as those have that are known; without them the first round is small enough.
    void requireMemoryFor(double paths) const {
        if (paths_ == 0) return;
        const double bytes =
            kBytesOfVertex * paths * static_cast<double>(vertices_.size()) / static_cast<double>(paths_);
        if (const double left = memoryLeft(); bytes > left)
            throw MemoryLimitExceeded(
                fmt::format("pilots of path guiding take {} more, {} are left; `guiding off` takes "
                            "none",
                            memoryText(bytes), memoryText(std::max(left, 0.0))));
    }

    // Of so many samples of each pixel, or of every so many-th of a row, guided by what is known.
    void round(std::uint32_t samples, int stride, std::uint64_t seed) {
        PathContext context = context_;
        context.settings.seed = seed;
        context.guide = guide_.get();
        context.choices |= guide_ != nullptr;
        const PilotFilm pixels(frame(), seed);
        requireMemoryFor(static_cast<double>(samples) * pixels.columns() * pixels.rows());
        const RouletteReference patient = RouletteReference::constant(kPatience);
        std::vector<RowFound> rows(static_cast<std::size_t>(pixels.rows()));
        parallelFor(rows.size(), [&](std::size_t row) {
            GuideFilm film(film_, rows[row], guide_.get(), shown_);
            addWorkFlag(WorkFlag::pilot);
            const auto first = static_cast<int>(combine64(seed, row) % static_cast<std::uint64_t>(stride));
            for (int column = first; column < pixels.columns() && !stop_(); column += stride) {
                const TileJob job{pixels.pixelOf(column, static_cast<int>(row)), 0, samples, &patient};
                const PathCounters c = render_(context, film, job).counters;
                rows[row].rays += c.vertices + c.shadowRays;
            }
            removeWorkFlag(WorkFlag::pilot);
        });
        if (std::ranges::any_of(rows, &RowFound::full)) throw std::bad_alloc();
        std::size_t all = vertices_.size();
        for (const RowFound& row : rows) all += row.vertices.size();
        vertices_.reserve(all);
        variances_.clear();
        variancesByChance_.clear();
        for (RowFound& row : rows) {
            vertices_.insert(vertices_.end(), row.vertices.begin(), row.vertices.end());
            variances_.insert(variances_.end(), row.variances.begin(), row.variances.end());
            variancesByChance_.insert(variancesByChance_.end(), row.variancesByChance.begin(),
                                      row.variancesByChance.end());
            radiance_ += row.radiance;
            paths_ += row.paths;
            plan_.rays += row.rays;
            row = {};
        }
    }

    const PathContext& context_;
    TileFunction render_;
    const Film& film_;
    const RouletteReference& shown_;
    const std::function<bool()>& stop_;
    std::vector<PilotVertex> vertices_; // of all rounds
    double radiance_ = 0;               // of all their paths
    std::uint64_t paths_ = 0;
    std::vector<double> variances_, variancesByChance_; // of the last round, as RowFound has them
    double variance_ = 0;                               // of the first, which has no guide
    double distancesLeave_ = 1;
    std::unique_ptr<PathGuide> guide_;
    GuidePlan plan_;
};

} // namespace

int GuideSize::within(PixelBounds frame, double most) {
    const PilotFilm pixels(frame, 0);
    int size = kMost;
    while (size > 0 && static_cast<double>(pixels.columns()) * pixels.rows() * samples(size) > most) --size;
    return size;
}

GuidePlan planGuide(const PathContext& context, TileFunction render, const Film& film, const RouletteReference& shown,
                    int size, const std::function<bool()>& stop) {
    return GuidePilots(context, render, film, shown, stop).run(size);
}

} // namespace abbe

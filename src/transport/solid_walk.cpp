#include "transport/solid_walk.h"

#include "render/film.h"
#include "render/medium.h"
#include "render/path_observer.h"
#include "render/scene.h"
#include "transport/roulette.h"

#include <algorithm>
#include <array>

namespace abbe {

namespace {

constexpr auto& kWalkShares = WalkPilot::kShares;
constexpr std::size_t kLookShare = 2; // in kWalkShares: that of the looks
static_assert(kWalkShares[kLookShare] == PulledShares::kUnknown);
using PerWalkShare = std::array<float, kWalkShares.size()>;

// Hears of the paths of one tile.
class WalkRecorder final : public SampleRecorder {
  public:
    explicit WalkRecorder(WalkPilot& to) : to_(to) {}
    ~WalkRecorder() override { to_.add(paths_, workOfOthers_); }

    void pixel(int x, int y, int) noexcept override {
        path_.x = x;
        path_.y = y;
    }
    void start(const Ray&, const Wavelengths& lambda) noexcept override {
        lambda_ = lambda;
        path_.medium = nullptr;
        work_ = kSurface;
        odds_.fill(1);
        shown_.fill(Spectrum(0.f));
    }
    void walked(const Medium& medium, float likelihood) noexcept override {
        if (!path_.medium) path_.medium = &medium;
        for (std::size_t i = 0; i < kWalkShares.size(); ++i) {
            const float pulled = kWalkShares[i] / kWalkShares[kLookShare],
                        scattered = (1 - kWalkShares[i]) / (1 - kWalkShares[kLookShare]);
            odds_[i] *= std::max(likelihood * pulled + (1 - likelihood) * scattered, kLeastOdds);
        }
    }
    void arrives(const SurfaceHit&, const Spectrum&) noexcept override { work_ += kSurface; }
    void collides(Vec3, const Spectrum&) noexcept override { ++work_; }
    void scatters(const SurfaceHit&, Lobes, const Spectrum&, const BsdfSample*) noexcept override {}
    void gathers(const Spectrum& radiance, const void*, bool) noexcept override {
        for (std::size_t i = 0; i < kWalkShares.size(); ++i) shown_[i] += radiance * (1 / odds_[i]);
    }
    void keep(const Spectrum& radiance, const Sensor& sensor, double) noexcept override {
        if (!path_.medium) {
            workOfOthers_ += work_;
            return;
        }
        for (std::size_t i = 0; i < kWalkShares.size(); ++i) {
            const auto y = static_cast<float>(sensor(shown_[i], lambda_).y);
            path_.squares[i] = y * y * odds_[i];
            path_.work[i] = static_cast<float>(work_) * odds_[i];
        }
        path_.shows = static_cast<float>(sensor(radiance, lambda_).y);
        paths_.push_back(path_);
    }
    void drop() noexcept override {}
    void pixelDone(double) noexcept override {}

  private:
    // Of a surface, or of the camera, in collisions: as they take time.
    static constexpr std::uint32_t kSurface = 3;
    static constexpr float kLeastOdds = 1e-6f; // rounding can make them 0

    WalkPilot& to_;
    std::vector<WalkPilot::Path> paths_;
    WalkPilot::Path path_;
    Wavelengths lambda_;
    std::uint32_t work_ = 0;
    std::uint64_t workOfOthers_ = 0;
    PerWalkShare odds_{};                              // of the path so far, by each share
    std::array<Spectrum, kWalkShares.size()> shown_{}; // by each
};

// Of all paths that walked in one medium first.
struct WalkSums {
    double paths = 0, shows = 0;
    std::array<double, kWalkShares.size()> squares{}, work{};

    // Of the share that has the least variance for the work, beside that of all other paths.
    std::size_t best(double workBeside) const {
        const double mean = shows / paths;
        const auto effort = [&](std::size_t i) { return (squares[i] / paths - mean * mean) * (work[i] + workBeside); };
        std::size_t least = 0;
        for (std::size_t i = 1; i < kWalkShares.size(); ++i)
            if (effort(i) < effort(least)) least = i;
        return least;
    }
};

} // namespace

bool WalkPilot::serves(const Scene& scene, const Medium& medium) {
    return !scene.mediumUses[medium.number].lit && SurfacePull::suits(medium.phase());
}

bool WalkPilot::wanted(const Scene& scene) {
    return std::ranges::any_of(scene.media, [&](const auto& medium) { return serves(scene, *medium); });
}

std::unique_ptr<SampleRecorder> WalkPilot::recorder() { return std::make_unique<WalkRecorder>(*this); }

void WalkPilot::add(const std::vector<Path>& paths, std::uint64_t workOfOthers) {
    const std::lock_guard lock(mutex_);
    workOfOthers_ += workOfOthers;
    paths_.insert(paths_.end(), paths.begin(), paths.end());
}

PulledShares WalkPilot::shares(const Scene& scene, const RouletteReference& roulette) {
    constexpr double kFewest = 64; // paths that say anything
    // So that sums do not depend on which thread was first; the samples of a pixel came in order.
    std::ranges::stable_sort(paths_, {}, [](const Path& p) { return std::pair(p.y, p.x); });
    std::vector<WalkSums> sums(scene.media.size());
    for (const Path& path : paths_) {
        WalkSums& to = sums[path.medium->number];
        const auto over = static_cast<double>(roulette.scale(path.x, path.y)); // what the pixel shows, up to a factor
        to.paths += 1;
        to.shows += over * path.shows;
        for (std::size_t i = 0; i < kWalkShares.size(); ++i) {
            to.squares[i] += over * over * path.squares[i];
            to.work[i] += path.work[i];
        }
    }
    auto all = static_cast<double>(workOfOthers_);
    for (const WalkSums& s : sums) all += s.work[kLookShare];
    std::vector<float> shares;
    for (const WalkSums& s : sums)
        shares.push_back(s.paths < kFewest ? PulledShares::kUnknown : kWalkShares[s.best(all - s.work[kLookShare])]);
    return PulledShares(std::move(shares));
}

} // namespace abbe

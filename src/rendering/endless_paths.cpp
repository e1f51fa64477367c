#include "rendering/endless_paths.h"

#include "base/parallel.h"
#include "base/work.h"
#include "render/stand_in_film.h"

#include <algorithm>
#include <map>
#include <mutex>

namespace abbe {

namespace {

constexpr std::size_t kLookedAtCells = 16, kNamedShapes = 4;
constexpr float kLossless = 0.9995f; // weight of a scattering that takes nothing away
constexpr double kMostly = 0.9;      // of the scatterings of long paths
constexpr double kWorthNaming = 0.1; // likewise, of one shape

struct LongScatterings {
    std::uint64_t paths = 0, longPaths = 0, all = 0;
    std::map<const Shape*, std::uint64_t> lossless;

    void add(const LongScatterings& s) {
        paths += s.paths;
        longPaths += s.longPaths;
        all += s.all;
        for (const auto& [shape, count] : s.lossless) lossless[shape] += count;
    }
};

// Counts what happens to paths that are long.
class LongPathRecorder final : public SampleRecorder {
  public:
    explicit LongPathRecorder(LongScatterings& to) : to_(to) {}

    void pixel(int, int, int) noexcept override {}
    void start(const Ray&, const Wavelengths&) noexcept override {
        ++to_.paths;
        vertex_ = 0;
    }
    void arrives(const SurfaceHit&, const Spectrum&) noexcept override { count(); }
    void collides(Vec3, const Spectrum&) noexcept override {
        count();
        to_.all += isLong();
    }
    void scatters(const SurfaceHit& hit, Lobes, const Spectrum&, const BsdfSample* next) noexcept override {
        if (!isLong()) return;
        ++to_.all;
        if (next && mean(next->weight) >= kLossless) ++to_.lossless[hit.shape];
    }
    void gathers(const Spectrum&, const void*, bool) noexcept override {}
    void keep(const Spectrum&, const Sensor&, double) noexcept override {}
    void drop() noexcept override {}
    void pixelDone(double) noexcept override {}

  private:
    bool isLong() const { return vertex_ > kLongPath; }
    void count() { to_.longPaths += ++vertex_ == kLongPath + 1; }

    LongScatterings& to_;
    std::uint32_t vertex_ = 0;
};

// Keeps no light.
class ListeningFilm final : public StandInFilm {
  public:
    explicit ListeningFilm(const Film& like) : StandInFilm(like) {}
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    std::unique_ptr<SampleRecorder> makeRecorder() override { return std::make_unique<LongPathRecorder>(heard); }

    LongScatterings heard;
};

std::vector<PixelBounds> dearestPixels(const PilotFilm& pilot) {
    std::vector<PixelBounds> pixels;
    for (int row = 0; row < pilot.rows(); ++row)
        for (int column = 0; column < pilot.columns(); ++column) pixels.push_back(pilot.pixelOf(column, row));
    const auto end = pixels.begin() + static_cast<std::ptrdiff_t>(std::min(pixels.size(), kLookedAtCells));
    std::partial_sort(pixels.begin(), end, pixels.end(),
                      [&](PixelBounds a, PixelBounds b) { return pilot.rays(a) > pilot.rays(b); });
    pixels.erase(end, pixels.end());
    return pixels;
}

EndlessPaths judge(const LongScatterings& heard) {
    std::vector<std::pair<std::uint64_t, const Shape*>> shapes;
    std::uint64_t lossless = 0;
    for (const auto& [shape, count] : heard.lossless) {
        lossless += count;
        shapes.emplace_back(count, shape);
    }
    EndlessPaths found;
    const auto all = static_cast<double>(heard.all);
    if (heard.all == 0 || static_cast<double>(lossless) < kMostly * all) return found;
    std::ranges::stable_sort(shapes, std::greater{}, [](const auto& s) { return s.first; });
    for (const auto& [count, shape] : shapes)
        if (found.shapes.size() < kNamedShapes && static_cast<double>(count) >= kWorthNaming * all)
            found.shapes.push_back(shape);
    found.share = static_cast<double>(heard.longPaths) / static_cast<double>(heard.paths);
    return found;
}

} // namespace

EndlessPaths findEndlessPaths(const PathContext& context, TileFunction render, const PilotFilm& pilot,
                              const RouletteReference& roulette) {
    const std::vector<PixelBounds> pixels = dearestPixels(pilot);
    LongScatterings heard;
    std::mutex mutex;
    parallelFor(pixels.size(), [&](std::size_t i) {
        ListeningFilm film(pilot);
        addWorkFlag(WorkFlag::pilot);
        render(context, film, {pixels[i], 0, PilotFilm::kSamples, &roulette});
        removeWorkFlag(WorkFlag::pilot);
        const std::lock_guard lock(mutex);
        heard.add(film.heard);
    });
    return judge(heard);
}

} // namespace abbe

// Samples spread by a frozen plan have the mean of even ones; samples spread by what they found themselves do not, and
// the same test sees that.
#include "support/scene_test.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr int kTile = 8;

// Means of tiles and of the image, a value for each independent render.
class TileMeans {
  public:
    explicit TileMeans(PixelBounds b)
        : bounds_(b), columns_((b.width() + kTile - 1) / kTile),
          tiles_(static_cast<std::size_t>(columns_ * ((b.height() + kTile - 1) / kTile))) {}

    // `y`: of a pixel.
    template <typename Y> void add(Y y) {
        std::vector<double> sums(tiles_.size());
        double whole = 0;
        for (int v = bounds_.y0; v < bounds_.y1; ++v)
            for (int u = bounds_.x0; u < bounds_.x1; ++u) {
                const double value = y(u, v);
                whole += value;
                sums[static_cast<std::size_t>((v - bounds_.y0) / kTile * columns_ + (u - bounds_.x0) / kTile)] += value;
            }
        for (std::size_t i = 0; i < sums.size(); ++i) tiles_[i].add(sums[i]);
        whole_.add(whole);
    }
    void add(const RecordingFilm& film) {
        add([&](int x, int y) { return film.mean(x, y).y; });
    }

    std::vector<Moments> tiles() const { return tiles_; }
    const Moments& whole() const { return whole_; }

  private:
    PixelBounds bounds_;
    int columns_;
    std::vector<Moments> tiles_;
    Moments whole_;
};

// The smallest of the probabilities that whole and tiles have the same mean, corrected for how many were asked.
double sameMeans(const TileMeans& a, const TileMeans& b) {
    const auto ours = a.tiles(), theirs = b.tiles();
    const int tests = static_cast<int>(ours.size()) + 1;
    double least = sameMeanTest(a.whole(), b.whole());
    for (std::size_t i = 0; i < ours.size(); ++i) least = std::min(least, sameMeanTest(ours[i], theirs[i]));
    return std::min(1.0, least * tests);
}

struct Outcome {
    TileMeans even, planned, greedy;
    int uneven = 0; // plans that were
};

// Many renders of few samples each, where what a pixel does with its samples matters most. Greedy: pixels whose first
// samples differ take four times as many, and keep the first.
Outcome renderAll(const TestScene& scene, std::uint32_t samples, int seeds) {
    const PixelBounds bounds = filmSettings(scene.built().film).crop;
    Outcome outcome{TileMeans(bounds), TileMeans(bounds), TileMeans(bounds)};
    RenderSettings settings = scene.settings();
    for (int seed = 1; seed <= seeds; ++seed) {
        settings.samples = samples;
        settings.seed = static_cast<std::uint64_t>(seed);
        const TestImage first = render(scene, settings, {}, 2);
        settings.samples = 4 * samples;
        const TestImage more = render(scene, settings, {}, 2);
        const double noise = first.film.relativeNoise();
        outcome.greedy.add([&](int x, int y) {
            const Estimate e = first.film.pixel(x, y);
            const bool quiet = e.variance <= square(0.5 * noise * e.mean);
            return quiet ? e.mean : more.film.mean(x, y).y;
        });
        settings.seed += 1000;
        settings.samples = 4 * samples;
        outcome.even.add(render(scene, settings, {}, 2).film);
        settings.seed += 1000;
        settings.samples = samples;
        settings.adaptive = true;
        const TestImage planned = render(scene, settings, {}, 2);
        settings.adaptive = false;
        outcome.planned.add(planned.film);
        const auto count = [&](int x, int y) { return planned.film.replicate(x, y, 0).second; };
        bool uneven = false;
        for (int y = bounds.y0; y < bounds.y1; ++y)
            for (int x = bounds.x0; x < bounds.x1; ++x) uneven |= count(x, y) != count(bounds.x0, bounds.y0);
        outcome.uneven += uneven;
    }
    return outcome;
}

} // namespace

TEST_CASE("adaptive: a frozen plan is unbiased, and a greedy rule is seen not to be") {
    for (const std::string path : {"scenes/glass-caustic/glass-caustic.scene", "scenes/many-lights/many-lights.scene",
                                   "scenes/veach-mis/veach-mis.scene"}) {
        if (!nightly() && path.find("glass") == std::string::npos) continue;
        CAPTURE(path);
        BuildOptions options;
        options.size = Vec2i{64, 64};
        const auto scene = TestScene::load(path, options);
        const int seeds = nightly() ? 200 : 40;
        const Outcome outcome = renderAll(scene, 4, seeds);
        CHECK(outcome.uneven >= seeds / 8); // else there is nothing to see
        const double planned = sameMeans(outcome.planned, outcome.even),
                     greedy = sameMeans(outcome.greedy, outcome.even);
        MESSAGE(path << ": " << outcome.uneven << " of " << seeds << " plans uneven; means "
                     << outcome.planned.whole().mean() / outcome.even.whole().mean() - 1 << ", greedy "
                     << outcome.greedy.whole().mean() / outcome.even.whole().mean() - 1 << " off; p " << planned
                     << ", greedy " << greedy);
        CHECK(planned > 1e-3);
        CHECK(greedy < 1e-6);
    }
}

} // namespace abbe::test

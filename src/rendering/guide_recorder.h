// What pilots of path guiding write down.
#pragma once

#include "guiding/guide_training.h"
#include "render/film.h"
#include "transport/roulette.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace abbe {

// What a row of pilots has found.
struct RowFound {
    std::vector<PilotVertex> vertices;
    std::vector<double> variances; // of a sample of each pixel, over the square of what the pixel shows
    // What these would be if distances in media were left to chance; the same where they are.
    std::vector<double> variancesByChance;
    double radiance = 0; // of all its paths, as PilotVertex has it
    std::uint64_t paths = 0, rays = 0;
    bool full = false; // there was no memory for more
};

// A film that keeps no picture: who watches its paths adds what they find to `found`. All outlive it. `guide`: of the
// paths, null if they have none. `shown`: what pixels show.
class GuideFilm final : public FilmDecorator {
  public:
    GuideFilm(const Film& like, RowFound& found, const PathGuide* guide, const RouletteReference& shown)
        : FilmDecorator(like), found_(found), guide_(guide), shown_(shown) {}
    int replicates() const override { return 1; }
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    std::unique_ptr<SampleRecorder> makeRecorder() override;

  private:
    RowFound& found_;
    const PathGuide* guide_;
    const RouletteReference& shown_;
};

} // namespace abbe

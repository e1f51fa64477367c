// A place for plans of a render that is not made.
#pragma once

#include "render/stand_in_film.h"

namespace abbe {

// The whole frame with the pixel filter of another film; takes all light and keeps none.
class PlanFilm final : public StandInFilm {
  public:
    PlanFilm(const Film& like, PixelBounds frame) : StandInFilm(like), frame_(frame) {}
    PixelBounds bounds() const override { return frame_; }
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    bool takesSplats() const override { return true; }
    bool takesMerged() const override { return true; }

  private:
    PixelBounds frame_;
};

} // namespace abbe

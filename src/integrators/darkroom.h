// A place for light that is only counted.
#pragma once

#include "render/film.h"

namespace abbe {

// A film that forgets all light, for looks ahead that listen or count.
class Darkroom final : public Film {
  public:
    explicit Darkroom(PixelBounds frame) : frame_(frame) {}
    PixelBounds bounds() const override { return frame_; }
    int replicates() const override { return 1; }
    FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    Xyz mean(int, int) const noexcept override { return {}; }
    double relativeNoise() const override { return 0; }
    bool takesSplats() const override { return true; }
    bool takesMerged() const override { return true; }

  private:
    PixelBounds frame_;
};

} // namespace abbe

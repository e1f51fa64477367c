// For films that stand in the place of another.
#pragma once

#include "render/film.h"

namespace abbe {

// Answers whatever it is asked as the other film does, so that everybody plans and draws alike with either; what is
// added is left to the derived class. The other film outlives it.
class StandInFilm : public Film {
  public:
    PixelBounds bounds() const override { return like_.bounds(); }
    int replicates() const override { return like_.replicates(); }
    FilterSample filter(Vec2 u) const noexcept override { return like_.filter(u); }
    float filterRadius() const noexcept override { return like_.filterRadius(); }
    float filterWeight(float offset) const noexcept override { return like_.filterWeight(offset); }
    Xyz mean(int x, int y) const noexcept override { return like_.mean(x, y); }
    double relativeNoise() const override { return like_.relativeNoise(); }
    bool takesSplats() const override { return like_.takesSplats(); }
    bool takesMerged() const override { return like_.takesMerged(); }

  protected:
    explicit StandInFilm(const Film& like) : like_(like) {}

  private:
    const Film& like_;
};

} // namespace abbe

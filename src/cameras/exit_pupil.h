// Where light can leave a lens towards a point of the film.
#pragma once

#include "cameras/lens_train.h"
#include "cameras/pupil_box.h"

namespace abbe {

// In the plane of the last vertex, boxes that hold every place through which light reaches the film at a distance from
// the axis; found by tracing at setup, for points on the +x axis of the film, the others being turned to there. As long
// as the stop is centred, a box that is too large costs samples and one that is too small would darken the picture, so
// each is a cell of the search grid larger than what was found.
class ExitPupil {
  public:
    using Box = PupilBox; // empty: no light reaches this distance

    ExitPupil() = default;
    // `film`: z of the film plane, behind the last surface; `radius`: of its farthest corner, m.
    ExitPupil(const LensTrain&, const Aperture& opening, double film, double radius);
    const Box& at(double filmRadius) const noexcept;

  private:
    std::vector<Box> boxes_; // of equal intervals of the radius
    double scale_ = 0;       // intervals per m
};

} // namespace abbe

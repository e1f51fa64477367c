// Where light can enter a lens from a point of the scene.
#pragma once

#include "cameras/exit_pupil.h"

#include <optional>

namespace abbe {

// In a plane across the axis, boxes that hold every place through which light of a direction reaches the film; found by
// tracing at setup, for directions in the plane of x and the axis, the others being turned to there. A point sees the
// lens in many directions: its box holds those of all of them. Boxes that are too large cost samples; light that misses
// one that is too small is left to the rays of the camera (Camera::pdfFacingArea is 0 there).
class EntrancePupil {
  public:
    // What a point aims at.
    struct Aim {
        double plane = 0;                           // z
        Vec2d turn{1, 0};                           // cosine and sine of the point's azimuth
        PupilBox box;                               // with that azimuth turned to +x; not empty
        Vec3d at(Vec2d u) const noexcept;           // u in [0, 1]²
        bool contains(Vec3d target) const noexcept; // a place of the plane
    };

    EntrancePupil() = default;
    // `pupil`: z of the middle of the paraxial entrance pupil; `film`: z of the film, `radius` of its farthest corner.
    EntrancePupil(const LensTrain&, const Aperture& opening, double pupil, const ExitPupil&, double film,
                  double radius);
    // From p, in lens coordinates; nothing if no light from there reaches the film, or p is not before the plane.
    std::optional<Aim> towards(Vec3d p) const noexcept;

  private:
    double plane_ = 0;
    std::vector<PupilBox> boxes_; // of equal intervals of the sine of the angle with the axis
    double scale_ = 0;            // intervals per sine
    double reach_ = 0;            // of the widest box
};

} // namespace abbe

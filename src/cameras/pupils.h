// Where light passes a lens: the part of a plane through which it can leave towards a point of the film, and that where
// it can enter from a point of the scene.
#pragma once

#include "cameras/lens_train.h"
#include "math/vec.h"

#include <algorithm>
#include <optional>

namespace abbe {

struct PupilBox {
    Vec2d lower, upper; // m; empty: no light passes

    double area() const { return std::max(0.0, upper.x - lower.x) * std::max(0.0, upper.y - lower.y); }
    // Of the corner farthest from the axis; 0 if empty.
    double reach() const {
        if (!(area() > 0)) return 0;
        return std::hypot(std::max(-lower.x, upper.x), std::max(-lower.y, upper.y));
    }
    bool contains(Vec2d p) const { return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y; }
    // Of both; an empty one counts for nothing.
    static PupilBox hull(const PupilBox& a, const PupilBox& b) {
        if (!(a.area() > 0)) return b;
        if (!(b.area() > 0)) return a;
        return {{std::min(a.lower.x, b.lower.x), std::min(a.lower.y, b.lower.y)},
                {std::max(a.upper.x, b.upper.x), std::max(a.upper.y, b.upper.y)}};
    }
};

// Cuts `area` into cells² of them: the hull of those in whose middle passes(Vec2d) holds and of those around them.
template <typename Passes> PupilBox scanPupil(const PupilBox& area, int cells, Passes&& passes) {
    const Vec2d step{(area.upper.x - area.lower.x) / cells, (area.upper.y - area.lower.y) / cells};
    PupilBox found;
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const Vec2d p{area.lower.x + (i + 0.5) * step.x, area.lower.y + (j + 0.5) * step.y};
            if (passes(p))
                found = PupilBox::hull(
                    found, {{p.x - 1.5 * step.x, p.y - 1.5 * step.y}, {p.x + 1.5 * step.x, p.y + 1.5 * step.y}});
        }
    return found;
}

// The same as closely as 48² cells tell, within the largest of which something is found at all.
template <typename Passes> PupilBox findPupil(const PupilBox& area, Passes&& passes) {
    for (const int cells : {32, 128, 512}) {
        const PupilBox coarse = scanPupil(area, cells, passes);
        if (coarse.area() > 0) return scanPupil(coarse, 48, passes);
    }
    return {};
}

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

#include "cameras/exit_pupil.h"

#include "base/check.h"

#include <algorithm>
#include <array>

namespace abbe {

namespace {

constexpr int kExitIntervals = 32;
constexpr std::array kExitWavelengths = {360.0, 430.0, 550.0, 830.0};

using Box = ExitPupil::Box;

class ExitSearch {
  public:
    ExitSearch(const LensTrain& train, const Aperture& opening, double film)
        : train_(train), opening_(opening), film_(film) {}

    // The box of what passes from a film point at `radius`.
    Box box(double radius) const {
        return findPupil(reach(radius), [&](Vec2d p) { return passes(radius, p); });
    }

  private:
    // The rim of the last surface seen from the film point, in the plane of the vertex.
    Box reach(double radius) const {
        const double h = train_.rearRadius();
        const double k = (film_ - train_.length()) / (film_ - train_.rearEdge());
        Box b{{-h, -h}, {h, h}};
        const auto add = [&](double x) {
            b.lower.x = std::min(b.lower.x, x);
            b.upper.x = std::max(b.upper.x, x);
        };
        add(radius + (h - radius) * k);
        add(radius - (h + radius) * k);
        b.lower.y = -h * std::max(1.0, k);
        b.upper.y = -b.lower.y;
        return b;
    }

    bool passes(double radius, Vec2d p) const {
        for (const double nm : kExitWavelengths) {
            const Vec3d from{radius, 0, film_};
            LensRay ray{from, normalize(Vec3d{p.x, p.y, train_.length()} - from)};
            if (train_.toScene(ray, nm, opening_)) return true;
            if (!train_.disperses()) return false;
        }
        return false;
    }

    const LensTrain& train_;
    const Aperture& opening_;
    double film_;
};

} // namespace

ExitPupil::ExitPupil(const LensTrain& train, const Aperture& opening, double film, double radius)
    : scale_(kExitIntervals / radius) {
    ABBE_CHECK(radius > 0 && film > train.length() && film > train.rearEdge());
    // Blades have the same box in every direction: that of the circle around them.
    const Aperture round(opening.outerRadius());
    const ExitSearch search(train, round, film);
    Box last = search.box(0);
    for (int i = 1; i <= kExitIntervals; ++i) {
        const Box next = search.box(i / scale_);
        boxes_.push_back(Box::hull(last, next));
        last = next;
    }
}

const ExitPupil::Box& ExitPupil::at(double filmRadius) const noexcept {
    return boxes_[static_cast<std::size_t>(std::clamp(filmRadius * scale_, 0.0, kExitIntervals - 1.0))];
}

} // namespace abbe

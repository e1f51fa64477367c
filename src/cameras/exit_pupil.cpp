#include "cameras/exit_pupil.h"

#include "base/check.h"

#include <array>

namespace abbe {

namespace {

constexpr int kIntervals = 32;
constexpr std::array kWavelengths = {360.0, 430.0, 550.0, 830.0};

using Box = ExitPupil::Box;

class Search {
  public:
    Search(const LensTrain& train, const Aperture& opening, double film)
        : train_(train), opening_(opening), film_(film) {}

    // The box of what passes from a film point at `radius`.
    Box box(double radius) const {
        const Box all = reach(radius);
        for (const int cells : {32, 128, 512}) {
            const Box coarse = scan(all, radius, cells);
            if (coarse.area() > 0) return scan(coarse, radius, 48);
        }
        return {};
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

    // The cells in whose middle a ray passes, and those around them.
    Box scan(const Box& area, double radius, int cells) const {
        const Vec2d step{(area.upper.x - area.lower.x) / cells, (area.upper.y - area.lower.y) / cells};
        Box found{{1, 1}, {-1, -1}};
        bool any = false;
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i) {
                const Vec2d p{area.lower.x + (i + 0.5) * step.x, area.lower.y + (j + 0.5) * step.y};
                if (!passes(radius, p)) continue;
                const Box cell{{p.x - 1.5 * step.x, p.y - 1.5 * step.y}, {p.x + 1.5 * step.x, p.y + 1.5 * step.y}};
                found = any ? hull(found, cell) : cell;
                any = true;
            }
        return any ? found : Box{};
    }

    bool passes(double radius, Vec2d p) const {
        for (const double nm : kWavelengths) {
            const Vec3d from{radius, 0, film_};
            LensRay ray{from, normalize(Vec3d{p.x, p.y, train_.length()} - from)};
            if (train_.toScene(ray, nm, opening_)) return true;
            if (!train_.disperses()) return false;
        }
        return false;
    }

  public:
    static Box hull(const Box& a, const Box& b) {
        return {{std::min(a.lower.x, b.lower.x), std::min(a.lower.y, b.lower.y)},
                {std::max(a.upper.x, b.upper.x), std::max(a.upper.y, b.upper.y)}};
    }

  private:
    const LensTrain& train_;
    const Aperture& opening_;
    double film_;
};

} // namespace

ExitPupil::ExitPupil(const LensTrain& train, const Aperture& opening, double film, double radius)
    : scale_(kIntervals / radius) {
    ABBE_CHECK(radius > 0 && film > train.length() && film > train.rearEdge());
    // Blades have the same box in every direction: that of the circle around them.
    const Aperture round(opening.outerRadius());
    const Search search(train, round, film);
    Box last = search.box(0);
    for (int i = 1; i <= kIntervals; ++i) {
        const Box next = search.box(i / scale_);
        boxes_.push_back(last.area() == 0 ? next : next.area() == 0 ? last : Search::hull(last, next));
        last = next;
    }
}

const ExitPupil::Box& ExitPupil::at(double filmRadius) const noexcept {
    return boxes_[static_cast<std::size_t>(std::clamp(filmRadius * scale_, 0.0, kIntervals - 1.0))];
}

} // namespace abbe

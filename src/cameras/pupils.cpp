#include "cameras/pupils.h"

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

namespace {

constexpr int kIntervals = 32;
constexpr std::array kWavelengths = {360.0, 430.0, 550.0, 830.0};
// Filters and overscan look at places beyond the corner.
constexpr double kBeyondCorner = 1.1;

class EntranceSearch {
  public:
    EntranceSearch(const LensTrain& train, const Aperture& opening, double plane)
        : train_(train), opening_(opening), plane_(plane) {}

    // The box of what passes at that angle with the axis, from the side of +x.
    PupilBox box(double sine) const {
        const Vec3d d{-sine, 0, std::sqrt(1 - sine * sine)};
        return findPupil(reach(d), [&](Vec2d p) { return passes(p, d); });
    }

    // Of the rays that leave the lens from places of the film up to `radius`.
    double widestSine(const ExitPupil& exit, double film, double radius) const {
        constexpr int cells = 32;
        double widest = 0;
        for (int i = 1; i <= cells; ++i) {
            const double r = radius * i / cells;
            const PupilBox& box = exit.at(r);
            for (int k = 0; k < cells * cells; ++k) {
                const double u = (k % cells + 0.5) / cells, v = (k / cells + 0.5) / cells;
                const Vec3d from{r, 0, film};
                const Vec3d to{box.lower.x + u * (box.upper.x - box.lower.x),
                               box.lower.y + v * (box.upper.y - box.lower.y), train_.length()};
                LensRay ray{from, normalize(to - from)};
                if (train_.toScene(ray, kWavelengths[static_cast<std::size_t>(k) % kWavelengths.size()], opening_))
                    widest = std::max(widest, std::hypot(ray.d.x, ray.d.y));
            }
        }
        return widest;
    }

  private:
    // What rays of a direction through the first surface meet of the plane.
    PupilBox reach(Vec3d d) const {
        const double h = train_.frontRadius(), edge = train_.frontEdge(), slope = d.x / d.z;
        const double near = (plane_ - std::max(0.0, edge)) * slope, far = (plane_ - std::min(0.0, edge)) * slope;
        return {{std::min(near, far) - h, -h}, {std::max(near, far) + h, h}};
    }

    bool passes(Vec2d p, Vec3d d) const {
        const Vec3d on{p.x, p.y, plane_};
        const double start = std::min(0.0, train_.frontEdge()) - train_.frontRadius();
        const Vec3d from = on - d * ((plane_ - start) / d.z);
        for (const double nm : kWavelengths) {
            LensRay ray{from, d};
            if (train_.toFilm(ray, nm, opening_)) return true;
            if (!train_.disperses()) return false;
        }
        return false;
    }

    const LensTrain& train_;
    const Aperture& opening_;
    double plane_;
};

} // namespace

Vec3d EntrancePupil::Aim::at(Vec2d u) const noexcept {
    const double x = box.lower.x + u.x * (box.upper.x - box.lower.x);
    const double y = box.lower.y + u.y * (box.upper.y - box.lower.y);
    return {turn.x * x - turn.y * y, turn.y * x + turn.x * y, plane};
}

bool EntrancePupil::Aim::contains(Vec3d p) const noexcept {
    return box.contains({turn.x * p.x + turn.y * p.y, turn.x * p.y - turn.y * p.x});
}

EntrancePupil::EntrancePupil(const LensTrain& train, const Aperture& opening, double pupil, const ExitPupil& exit,
                             double film, double radius)
    : plane_(std::max(0.0, pupil)) { // behind whatever the lens sees
    ABBE_CHECK(radius > 0);
    // Blades have the same box in every direction: that of the circle around them.
    const Aperture round(opening.outerRadius());
    const EntranceSearch search(train, round, plane_);
    const double widest = std::min(0.999, 1.02 * search.widestSine(exit, film, kBeyondCorner * radius) + 1e-6);
    scale_ = kIntervals / widest;
    PupilBox last = search.box(0);
    for (int i = 1; i <= kIntervals; ++i) {
        const PupilBox next = search.box(i / scale_);
        boxes_.push_back(PupilBox::hull(last, next));
        reach_ = std::max(reach_, boxes_.back().reach());
        last = next;
    }
}

// Towards places within `reach` of the axis the directions from p have slopes within reach / height of that towards the
// axis, and azimuths within asin(reach / distance from the axis) of its own; a box that turns by an angle stays within
// reach · angle of its place.
std::optional<EntrancePupil::Aim> EntrancePupil::towards(Vec3d p) const noexcept {
    const double height = plane_ - p.z, off = std::hypot(p.x, p.y);
    if (!(height > 0) || !(off < kInfinity)) return std::nullopt;
    const auto interval = [&](double away) { return std::max(0.0, away) / std::hypot(away, height) * scale_; };
    const double first = interval(off - reach_), last = std::min(interval(off + reach_), kIntervals - 0.5);
    Aim aim{plane_, {1, 0}, {}};
    for (double i = std::floor(first); i <= last; ++i)
        aim.box = PupilBox::hull(aim.box, boxes_[static_cast<std::size_t>(i)]);
    const double reach = aim.box.reach();
    if (!(reach > 0)) return std::nullopt;
    if (off > 2 * reach) {
        const double margin = reach * std::asin(reach / off);
        aim.turn = {p.x / off, p.y / off};
        aim.box.lower = aim.box.lower - Vec2d{margin, margin};
        aim.box.upper = aim.box.upper + Vec2d{margin, margin};
    } else {
        aim.box = {{-reach, -reach}, {reach, reach}};
    }
    return aim;
}

} // namespace abbe

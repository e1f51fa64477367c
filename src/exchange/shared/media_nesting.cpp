#include "exchange/shared/media_nesting.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

using Surface = FilledShape::Surface;

// With some room for rounding: shapes that touch what holds them are in it.
bool holds(const Bounds3d& outer, const Bounds3d& inner) {
    const double room = 1e-5 * length(outer.diagonal());
    for (int i = 0; i < 3; ++i)
        if (inner.lower[i] < outer.lower[i] - room || inner.upper[i] > outer.upper[i] + room) return false;
    return true;
}

} // namespace

void MediaNesting::note(FilledShape shape) {
    if (shape.isFilled) filled_.push_back(shapes_.size());
    shapes_.push_back(std::move(shape));
}

bool MediaNesting::isHeldAt(const void* medium, Vec3d point) const {
    return std::ranges::any_of(filled_, [&](std::size_t i) {
        const FilledShape& s = shapes_[i];
        return s.inside == medium && s.box && holds(*s.box, {point, point});
    });
}

// The filled shapes that hold a shape, or that reach an opaque one, from which a ray is thrown back.
std::vector<const FilledShape*> MediaNesting::around(const FilledShape& shape) const {
    std::vector<const FilledShape*> found;
    for (const std::size_t i : filled_) {
        const FilledShape& s = shapes_[i];
        if (&s == &shape || !s.box || !shape.box) continue;
        const bool isEqual = holds(*s.box, *shape.box) && holds(*shape.box, *s.box);
        if (shape.surface == Surface::opaque ? s.box->overlaps(*shape.box) : !isEqual && holds(*s.box, *shape.box))
            found.push_back(&s);
    }
    return found;
}

void MediaNesting::reportOutside(const FilledShape& shape, const std::vector<const FilledShape*>& around,
                                 const std::string& property, Import& import) const {
    if (std::ranges::any_of(around, [&](const FilledShape* s) { return s->inside == shape.outside; })) return;
    const bool isSomewhere =
        std::ranges::any_of(filled_, [&](std::size_t i) { return shapes_[i].inside == shape.outside; });
    if (isSomewhere && !shape.box) return; // where instances stand is not followed
    import.leftOut(nullptr, shape.span, fmt::format("{} of {}", property, shape.name),
                   isSomewhere ? "the shape that is filled with this medium does not hold it"
                               : "a medium fills a closed shape, or is everywhere where the camera is in it; no shape "
                                 "is filled with this one, and the camera is not in it");
}

void MediaNesting::report(const void* atmosphere, const std::string& property, Import& import) const {
    constexpr double kMostPairs = 2e7; // a second
    if (static_cast<double>(shapes_.size()) * static_cast<double>(filled_.size()) > kMostPairs)
        return import.approximated(nullptr, shapes_[0].span, fmt::format("media of {} shapes", shapes_.size()),
                                   fmt::format("whether they hold each other, as {} says, is not looked at: there "
                                               "are too many",
                                               property));
    for (const FilledShape& shape : shapes_) {
        const auto outer = around(shape);
        const bool inAir = shape.outside && shape.outside == atmosphere;
        if (shape.outside && !inAir && shape.outside != shape.inside) reportOutside(shape, outer, property, import);
        if (shape.surface == Surface::opaque || shape.inside == shape.outside) continue;
        const bool displaces = shape.surface == Surface::dielectric;
        const bool isAdded = std::ranges::any_of(outer, [&](const FilledShape* s) {
            return !(displaces && s->surface == Surface::dielectric) && s->inside != shape.inside;
        });
        if (atmosphere && shape.inside == atmosphere && shape.isFilled)
            import.approximated(nullptr, shape.span, fmt::format("the medium inside of {}", shape.name),
                                "the camera is in the same one, which is everywhere: it is twice as dense here");
        else if (atmosphere || isAdded)
            import.approximated(nullptr, shape.span,
                                shape.inside ? fmt::format("the medium inside of {}", shape.name)
                                             : fmt::format("the inside of {}, without a medium,", shape.name),
                                "what is around it goes on inside, as media here add up");
    }
}

} // namespace abbe::exchange

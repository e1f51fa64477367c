// Part of a plane through which light passes a lens.
#pragma once

#include "math/vec.h"

#include <algorithm>

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

} // namespace abbe

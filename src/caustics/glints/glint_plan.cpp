#include "caustics/glints/glint_plan.h"

#include <algorithm>
#include <utility>

namespace abbe {

namespace {

// A box that another one of the same chain shares would be probed twice.
std::vector<Glint> disjoint(std::vector<Glint> glints) {
    for (std::size_t i = 0; i < glints.size(); ++i)
        for (std::size_t j = i + 1; j < glints.size(); ++j) {
            Glint &a = glints[i], &b = glints[j];
            if (a.chain != b.chain || !a.box.overlaps(b.box)) continue;
            a.box = a.box.united(b.box);
            a.side = std::max(a.side, b.side);
            std::swap(b, glints.back());
            glints.pop_back();
            j = i; // the larger box may overlap others
        }
    return glints;
}

} // namespace

GlintPlan::GlintPlan(PixelBounds frame, float reach, std::vector<Glint> glints, std::unordered_set<const Light*> lights)
    : frame_(frame), glints_(disjoint(std::move(glints))), lights_(std::move(lights)),
      rows_(static_cast<std::size_t>(frame.height())) {
    for (std::uint32_t i = 0; i < glints_.size(); ++i)
        for (int y = frame.y0; y < frame.y1; ++y) {
            const float middle = static_cast<float>(y) + 0.5f;
            const FilmBox& box = glints_[i].box;
            if (box.lower.y < middle + reach && box.upper.y > middle - reach)
                rows_[static_cast<std::size_t>(y - frame.y0)].push_back(i);
        }
}

std::span<const std::uint32_t> GlintPlan::ofRow(int y) const {
    if (y < frame_.y0 || y >= frame_.y1) return {};
    return rows_[static_cast<std::size_t>(y - frame_.y0)];
}

} // namespace abbe

#include "caustics/glints/glint_plan.h"

#include "light_sampling/light_target.h"
#include "math/sobol.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace abbe {

namespace {

constexpr float kLargest = 0.1f; // rad: what is wider has no small images
constexpr int kPoints = 16;

std::optional<GlintLight> smallDistantLight(const Light& light) {
    std::vector<Vec3> directions;
    Vec3 sum;
    for (int i = 0; i < kPoints; ++i) {
        const Vec2 u{(static_cast<float>(i) + 0.5f) / kPoints,
                     static_cast<float>(reverseBits(static_cast<std::uint32_t>(i))) * 0x1p-32f};
        const auto s = light.asDistant()->sampleDistant(u, Wavelengths::sample(0.5f), 0);
        if (!s || s->delta) return std::nullopt;
        directions.push_back(s->wi);
        sum = sum + s->wi;
    }
    GlintLight small{&light, true, normalize(sum), 0};
    for (const Vec3 w : directions) small.size = std::max(small.size, length(w - small.place));
    return small.size > 0 && small.size < kLargest ? std::optional(small) : std::nullopt;
}

std::optional<GlintLight> smallPlacedLight(const Light& light) {
    if (light.parts() != 1) return std::nullopt;
    const auto bounds = light.bounds(0);
    const auto target = LightTarget::sample(light, 0, 1, {0.5f, 0.5f}, Wavelengths::sample(0.5f), 0);
    if (!bounds || !target || target->delta) return std::nullopt;
    const Vec3 size = bounds->box.upper - bounds->box.lower;
    return GlintLight{&light, false, (bounds->box.lower + bounds->box.upper) * 0.5f,
                      0.5f * std::max({size.x, size.y, size.z})};
}

} // namespace

std::vector<GlintLight> glintLights(const Scene& scene, std::size_t most) {
    std::vector<GlintLight> lights;
    for (const auto& light : scene.lights) {
        if (light->paths() == LightPaths::none || !(light->visiblePower() > 0)) continue;
        const auto small = light->paths() == LightPaths::distant ? smallDistantLight(*light) : smallPlacedLight(*light);
        if (small) lights.push_back(*small);
    }
    std::ranges::stable_sort(lights, [](const GlintLight& a, const GlintLight& b) {
        return a.source->visiblePower() > b.source->visiblePower();
    });
    if (lights.size() > most) lights.resize(most);
    return lights;
}

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

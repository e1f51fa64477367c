#include "lights/window_light.h"

#include "math/warp.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// About how bright a light is, in no unit: a mean over wavelengths that weighs what eyes see, and leaves no colour out.
class Brightness {
  public:
    explicit Brightness(const DistantLight& light) : light_(light) {
        constexpr std::array<float, kLanes> eye = {0.05f, 0.1f, 0.25f, 0.8f, 1.f, 0.7f, 0.25f, 0.05f};
        for (int i = 0; i < kLanes; ++i) weights_.v[i] = eye[static_cast<std::size_t>(i)];
    }
    double operator()(Vec3 w) const { return static_cast<double>(sum(light_.escaped(w, lambda_, 0) * weights_)); }

  private:
    const DistantLight& light_;
    Wavelengths lambda_ = Wavelengths::sample(0.0625f); // 1/16, 3/16, …
    Spectrum weights_;
};

} // namespace

Portals::Portals(const std::vector<std::array<Vec3d, 4>>& corners, const std::function<double(Vec3)>& luminance,
                 const std::optional<Room>& room)
    : room_(room) {
    portals_.reserve(corners.size());
    for (const auto& four : corners)
        portals_.emplace_back(four, luminance, portals_.empty() ? nullptr : &portals_.back());
}

struct Portals::Seen {
    std::array<std::pair<const Portal*, Portal::View>, kMost> views;
    std::size_t count = 0;
    double weight = 0; // of all
};

Portals::Seen Portals::seen(const Receiver& from) const noexcept {
    Seen result;
    for (const Portal& portal : portals_) {
        if (portal.behind(from)) continue;
        if (const auto view = portal.view(from)) {
            result.views[result.count++] = {&portal, *view};
            result.weight += view->weight;
        }
    }
    return result;
}

float Portals::pdf(const Seen& seen, Vec3 w) noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < seen.count; ++i) {
        const auto& [portal, view] = seen.views[i];
        sum += view.weight * static_cast<double>(portal->pdf(view, w));
    }
    return static_cast<float>(sum / seen.weight);
}

bool Portals::inside(Vec3 p) const noexcept {
    return (!room_ || room_->contains(p)) &&
           std::ranges::any_of(portals_, [&](const Portal& portal) { return portal.inside(p); });
}

std::optional<Portal::Sample> Portals::sample(const Receiver& from, Vec2 u) const noexcept {
    const Seen all = seen(from);
    if (all.count == 0) return std::nullopt;
    double rest = static_cast<double>(u.x) * all.weight;
    std::size_t chosen = 0;
    while (chosen + 1 < all.count && rest >= all.views[chosen].second.weight) rest -= all.views[chosen++].second.weight;
    const auto& [portal, view] = all.views[chosen];
    u.x = std::clamp(static_cast<float>(rest / view.weight), 0.f, kOneMinusEpsilon);
    Portal::Sample s = portal->sample(view, u);
    // They may overlap: the density of each counts. Rounding may put a direction just outside of its own.
    s.pdf = std::max(pdf(all, s.w), s.pdf * static_cast<float>(view.weight / all.weight));
    return s;
}

float Portals::pdf(const Receiver& from, Vec3 w) const noexcept {
    const Seen all = seen(from);
    return all.count > 0 ? pdf(all, w) : 0;
}

float Portals::share(Vec3 p) const noexcept {
    float sum = 0;
    for (const Portal& portal : portals_) sum += portal.share(p);
    return std::min(sum, 1.f);
}

bool Portals::cross(Vec3 p, Vec3 w) const noexcept {
    return std::ranges::any_of(portals_, [&](const Portal& portal) { return portal.crosses(p, w); });
}

WindowLight::WindowLight(std::unique_ptr<DistantLight> light, const std::vector<std::array<Vec3d, 4>>& corners,
                         const std::optional<Room>& room)
    : light_(std::move(light)), portals_(corners, Brightness(*light_), room) {}

std::optional<LightSample> WindowLight::sample(const Receiver& from, std::uint32_t part, Vec2 u,
                                               const Wavelengths& lambda, float time) const noexcept {
    if (!portals_.inside(from.p)) return light_->sample(from, part, u, lambda, time);
    const auto s = portals_.sample(from, u);
    if (!s) return std::nullopt;
    return std::optional<LightSample>(std::in_place, s->w, Vec3{}, kInfinity, light_->escaped(s->w, lambda, time),
                                      s->pdf);
}

float WindowLight::pdfEscaped(const Receiver& from, Vec3 w, float time) const noexcept {
    return portals_.inside(from.p) ? portals_.pdf(from, w) : light_->pdfEscaped(from, w, time);
}

float WindowLight::inSight(const Receiver& from) const noexcept {
    return portals_.inside(from.p) ? std::max(portals_.share(from.p), kBesidePortals) : light_->inSight(from);
}

std::optional<std::vector<std::array<Vec3d, 4>>> portalCorners(const PortalParams& params, const LightContext& context,
                                                               Diagnostics& diagnostics) {
    const std::vector<Vec3d>& points = params.portals;
    if (points.size() % 4 != 0 || points.size() > 4 * Portals::kMost) {
        diagnostics.error("E0753", context.span, fmt::format("{} corners are no portals", points.size()),
                          fmt::format("four for each, at most {} portals", Portals::kMost));
        return std::nullopt;
    }
    std::vector<std::array<Vec3d, 4>> result;
    for (std::size_t i = 0; i < points.size(); i += 4) {
        std::array<Vec3d, 4> corners;
        for (std::size_t k = 0; k < 4; ++k) corners[k] = context.toRender.point(points[i + k]);
        if (!Portal::isRectangle(corners)) {
            diagnostics.error("E0753", context.span, fmt::format("portal {} is no rectangle", i / 4 + 1),
                              "`portals` takes the four corners of each in order");
            return std::nullopt;
        }
        if (context.toRender.determinant() < 0) std::swap(corners[1], corners[3]);
        result.push_back(corners);
    }
    return result;
}

Portals portalsFor(const DistantLight& light, const std::vector<std::array<Vec3d, 4>>& corners,
                   const LightContext& context, const Digest& radiance) {
    DigestWriter key("portals");
    key.add(radiance);
    for (const auto& four : corners)
        for (const Vec3d corner : four) key.add(corner);
    KeptTables* const kept = radiance == Digest{} ? nullptr : context.kept;
    return *KeptTables::get<Portals>(kept, key.digest(), [&] {
        return std::make_shared<const Portals>(corners, Brightness(light));
    }); // whose tables are shared
}

std::unique_ptr<DistantLight> throughWindows(std::unique_ptr<DistantLight> light, const PortalParams& params,
                                             const LightContext& context, const Digest& radiance,
                                             Diagnostics& diagnostics) {
    const auto corners = portalCorners(params, context, diagnostics);
    if (!corners) return nullptr;
    if (!light || corners->empty() || !context.besideScattering) return light;
    Portals portals = portalsFor(*light, *corners, context, radiance);
    return std::make_unique<WindowLight>(std::move(light), std::move(portals));
}

} // namespace abbe

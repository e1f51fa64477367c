// Light from far away that enters a room through windows: any light of some extent, sampled through them.
#pragma once

#include "base/diagnostic.h"
#include "lights/light_context.h"
#include "lights/portal.h"
#include "render/light.h"
#include "schema/type.h"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace abbe {

// A base of parameters.
struct PortalParams {
    std::vector<Vec3d> portals; // four corners of each, in the space of the light's parent
};

template <typename P> schema::FieldInfo portalsField() {
    return schema::field<P, std::vector<Vec3d>>(schema::FieldType::points, "portals", &P::portals)
        .unit({schema::Dimension::length})
        .doc("Windows through which the light enters a room: four corners of a rectangle each, counter-clockwise seen "
             "from inside. They only help: nothing else changes.")
        .example("portals { - -1 1 -3; - 1 1 -3; - 1 2 -3; - -1 2 -3 }")
        .synonyms({"portal", "windows"});
}

// A box in render space.
struct Room {
    Frame axes;
    Bounds3 box; // along them

    bool contains(Vec3 p) const {
        const Vec3 local = axes.toLocal(p), size = box.diagonal();
        const float rounding = 1e-3f * (size.x + size.y + size.z);
        return Bounds3{box.lower - Vec3(rounding, rounding, rounding), box.upper + Vec3(rounding, rounding, rounding)}
            .contains(local);
    }
};

// The windows of a light, in render space. Immutable, thread-safe.
class Portals {
  public:
    static constexpr std::size_t kMost = 32;

    // `luminance` as Portal has it. Requires: at most kMost, rectangles.
    // Without a room what lies behind any of the windows is one.
    Portals(const std::vector<std::array<Vec3d, 4>>& corners, const std::function<double(Vec3)>& luminance,
            const std::optional<Room>& room = {});

    // Whether a place is in a room behind any of them.
    bool inside(Vec3 p) const noexcept;
    // A direction through those that a receiver in a room sees, each in proportion to what is seen through it; nothing
    // if it sees none. u in [0, 1)².
    std::optional<Portal::Sample> sample(const Receiver&, Vec2 u) const noexcept;
    float pdf(const Receiver&, Vec3 w) const noexcept; // of sample(), 1/sr
    // Of the half of all directions those through windows, roughly; at most 1.
    float share(Vec3 p) const noexcept;
    // Whether light from a unit direction w arrives through a window.
    bool cross(Vec3 p, Vec3 w) const noexcept;

  private:
    struct Seen;
    Seen seen(const Receiver&) const noexcept;
    static float pdf(const Seen&, Vec3 w) noexcept;

    std::vector<Portal> portals_;
    std::optional<Room> room_;
};

// What may arrive at a place from which it is not seen through any window: a window may have been forgotten. Share of
// an open sky's.
inline constexpr float kBesidePortals = 0.003f;

// In a room only directions through the windows are sampled: light that comes another way is found by scattering alone,
// so that it needs both strategies. Outside the light is sampled as ever.
class WindowLight final : public DistantLight {
  public:
    // Requires: a light with an extent.
    WindowLight(std::unique_ptr<DistantLight> light, const std::vector<std::array<Vec3d, 4>>& corners,
                const std::optional<Room>& room = {});
    WindowLight(std::unique_ptr<DistantLight> light, Portals portals)
        : light_(std::move(light)), portals_(std::move(portals)) {}

    const Portals& portals() const { return portals_; }

    void commit(const Bounds3& bounds) override { light_->commit(bounds); }
    // Scattering does not find windows as it finds an even sky.
    LightOutput output() const override {
        LightOutput output = light_->output();
        output.even = false;
        return output;
    }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t part, Vec2 u, const Wavelengths&,
                                      float time) const noexcept override;
    Spectrum escaped(Vec3 w, const Wavelengths& lambda, float time) const noexcept override {
        return light_->escaped(w, lambda, time);
    }
    float pdfEscaped(const Receiver&, Vec3 w, float time) const noexcept override;
    float inSight(const Receiver&) const noexcept override;
    // Windows are seen from places alone.
    std::optional<LightSample> sampleDistant(Vec2 u, const Wavelengths& lambda, float time) const noexcept override {
        return light_->sampleDistant(u, lambda, time);
    }
    float pdfDistant(Vec3 w, float time) const noexcept override { return light_->pdfDistant(w, time); }

  private:
    std::unique_ptr<DistantLight> light_;
    Portals portals_;
};

// Corners of all windows of a light, in render space; nothing after an error.
std::optional<std::vector<std::array<Vec3d, 4>>> portalCorners(const PortalParams&, const LightContext&, Diagnostics&);

// The windows with these corners for a light, whose radiance in all directions `radiance` stands for; {} for nothing.
Portals portalsFor(const DistantLight&, const std::vector<std::array<Vec3d, 4>>& corners, const LightContext&,
                   const Digest& radiance);

// The light as it enters through its windows, if there are any and samples may leave out what scattering finds. Null
// stays null, or comes after an error.
std::unique_ptr<DistantLight> throughWindows(std::unique_ptr<DistantLight>, const PortalParams&, const LightContext&,
                                             const Digest& radiance, Diagnostics&);

} // namespace abbe

// Cameras of all kinds, each with a surface before it that the tests of connections look at.
#pragma once

#include "camera_fixture.h"
#include "cameras/altered_camera.h"
#include "cameras/lens_system.h"
#include "cameras/perspective.h"
#include "cameras/projections.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace abbe::test {

// A surface that sends out light, with coordinates in the unit square.
class LitSurface {
  public:
    struct Point {
        Vec3d p, n;
        double area = 0; // m² per unit of the square
        Vec2d at;
    };
    virtual ~LitSurface() = default;
    virtual Point point(Vec2d at) const = 0;
    virtual std::optional<Point> met(const Ray&) const = 0;
};

class Sheet final : public LitSurface {
  public:
    Sheet(Vec3d middle, Vec3d right, Vec3d up) : corner_(middle - right - up), a_(right * 2), b_(up * 2) {}
    Point point(Vec2d at) const override {
        const Vec3d n = cross(a_, b_);
        return {corner_ + a_ * at.x + b_ * at.y, normalize(n), length(n), at};
    }
    std::optional<Point> met(const Ray& ray) const override {
        const Vec3d o = exact(ray.origin) - corner_, d = exact(ray.direction), n = cross(a_, b_);
        const double t = -dot(o, n) / dot(d, n);
        const Vec3d q = o + d * t;
        const double n2 = dot(n, n);
        const Vec2d at{dot(cross(q, b_), n) / n2, dot(cross(a_, q), n) / n2};
        if (!(t > 0 && at.x >= 0 && at.x < 1 && at.y >= 0 && at.y < 1)) return std::nullopt;
        return point(at);
    }

  private:
    Vec3d corner_, a_, b_;
};

// Around the origin; its coordinates are longitude and latitude.
class Ball final : public LitSurface {
  public:
    explicit Ball(double radius) : radius_(radius) {}
    Point point(Vec2d at) const override {
        const double lon = 2 * kPiD * at.x, lat = kPiD * (at.y - 0.5), across = std::cos(lat);
        const Vec3d n{across * std::cos(lon), std::sin(lat), across * std::sin(lon)};
        return {n * radius_, n, 2 * kPiD * kPiD * across * radius_ * radius_, at};
    }
    std::optional<Point> met(const Ray& ray) const override {
        const Vec3d d = exact(ray.direction);
        const double lon = std::atan2(d.z, d.x) / (2 * kPiD);
        return point({lon < 0 ? lon + 1 : lon, std::asin(std::clamp(d.y, -1.0, 1.0)) / kPiD + 0.5});
    }

  private:
    double radius_;
};

// Differs over places, directions, times and wavelengths.
inline double radiance(Vec3d p, Vec3d w, float time, float nm) {
    return (1.2 + std::sin(2 * p.x + p.y) * std::cos(1.5 * p.z - p.y) + 0.6 * dot(w, Vec3d{0.6, -0.5, 0.4})) *
           (0.6 + static_cast<double>(time)) * (0.8 + static_cast<double>(nm) / 1000);
}

struct View {
    std::string name;
    PlacedCamera placed;
    Vec2i size;
    std::unique_ptr<LitSurface> receiver;
    float margin = 1; // around the frame, pixels
    int samples = 300'000;

    Vec2 lower() const { return {-margin, -margin}; }
    Vec2 upper() const { return {static_cast<float>(size.x) + margin, static_cast<float>(size.y) + margin}; }
    double pixels() const {
        return static_cast<double>(upper().x - lower().x) * static_cast<double>(upper().y - lower().y);
    }
    LensQuery query(Vec3 p, Vec2 lens, float time, float nm) const { return {p, lens, time, nm, lower(), upper()}; }
};

inline Vec2 inSquare(Random& random) { return {random.uniform(), random.uniform()}; }

template <typename Params, typename Make>
View view(std::string name, Make make, const Params& p, Vec2i size, std::unique_ptr<LitSurface> receiver) {
    return {std::move(name), made(make, p, size), size, std::move(receiver)};
}
inline std::unique_ptr<LitSurface> sheet(Vec3d middle, Vec3d right, Vec3d up) {
    return std::make_unique<Sheet>(middle, right, up);
}

inline void addPerspectives(std::vector<View>& all) {
    const Vec2i size{36, 24};
    PerspectiveParams p;
    p.lens = 0.018; // 90° across
    all.push_back(view("wide pinhole", makePerspective, p, size, sheet({0, 0, -2}, {2.2, 0, 0.4}, {0, 1.5, 0.2})));
    p.lookAt = Vec3d{1, -0.5, 0.7};
    all.push_back(view("pinhole that looks aside", makePerspective, p, size,
                       sheet({1.5, -0.75, 1.05}, {-1.1, 0, 1.6}, {0.5, 1.4, 0.4})));
    p = {};
    p.lens = 0.03;
    p.aperture = 0.3;
    p.focus = at(0.7);
    all.push_back(
        view("huge lens close by", makePerspective, p, size, sheet({0, 0, -0.4}, {0.5, 0, 0.1}, {0, 0.4, 0.1})));
    p.aperture = 0.1;
    p.blades = 5;
    p.bladeRotation = 0.3;
    p.bladeRoundness = 0.4;
    p.squeeze = 2;
    p.shift = {0.004, -0.006};
    p.focus.reset(); // infinite
    all.push_back(view("blades, squeeze and shift", makePerspective, p, size,
                       sheet({0.4, -0.2, -1}, {1.4, 0, 0.1}, {0.2, 0.6, 0})));
    p = {};
    p.lens = 0.05;
    p.aperture = 0.07;
    p.focus = at(0.8);
    p.tilt = {32 * kDegree, -24 * kDegree};
    all.push_back(view("tilted lens", makePerspective, p, size, sheet({0, 0, -0.4}, {0.25, 0, 0.05}, {0, 0.2, -0.05})));
}

inline void addOthers(std::vector<View>& all) {
    OrthographicParams o;
    o.width = 3;
    o.lookAt = Vec3d{0.3, -1, -0.5};
    all.push_back(view("orthographic", makeOrthographic, o, {30, 20},
                       sheet(Vec3d{0.3, -1, -0.5} * 3, {1.8, 0.2, 0}, {0, 0.4, -1.4})));
    all.push_back(view("whole panorama", makeSpherical, SphericalParams{}, {32, 16}, std::make_unique<Ball>(2)));
    all.back().margin = 2;
    SphericalParams s;
    s.width = 120 * kDegree;
    s.height = 80 * kDegree;
    s.lookAt = Vec3d{1, 0.4, 0.3};
    all.push_back(view("part of a panorama", makeSpherical, s, {30, 20},
                       sheet(Vec3d{1, 0.4, 0.3}, {-0.3, 0, 1.5}, {0.1, 0.9, 0})));
    // Turns, moves, and opens and closes slowly.
    PerspectiveParams p;
    p.aperture = 0.1;
    p.focus = at(2);
    p.shutter = 1;
    p.opening = 0.8;
    p.closing = 0.4;
    p.moments = {{0, {}, Vec3d{0, 0, 0}, Vec3d{0, 0, -1}, {}},
                 {2, {}, Vec3d{0.5, 0.2, 0.4}, Vec3d{1.1, 0.3, -0.6}, {}}};
    View moving = view("moving", makePerspective, p, {36, 24}, sheet({0.5, 0, -1.7}, {1.6, 0, 0.2}, {0, 0.9, 0.1}));
    moving.placed.camera = std::make_unique<ShutterCamera>(
        std::move(moving.placed.camera), moving.placed.toWorld.then(Transform::translate(-moving.placed.origin)),
        moving.placed.shutter);
    all.push_back(std::move(moving));
}

// Without depth of field, and without motion.
inline void addHeld(std::vector<View>& all) {
    const std::size_t count = all.size();
    for (std::size_t i = 0; i < count; ++i) {
        const bool lens = all[i].name == "blades, squeeze and shift", moving = all[i].name == "moving";
        if (!lens && !moving) continue;
        std::vector<View> again;
        if (lens) addPerspectives(again);
        if (moving) addOthers(again);
        View held = std::move(*std::ranges::find(again, all[i].name, &View::name));
        held.name += ", held";
        held.placed.camera = std::make_unique<ReducedCamera>(std::move(held.placed.camera), lens, moving);
        all.push_back(std::move(held));
    }
}

inline LensSystemParams lens(std::string_view name, double stop) {
    LensSystemParams p;
    p.prescription.word = std::string(name);
    p.fStop = stop;
    p.lens = 0.05;
    p.focus = at(1.5);
    return p;
}

inline void addLensSystems(std::vector<View>& all) {
    const Vec2i size{36, 24};
    const auto add = [&](std::string name, const LensSystemParams& p, Vec3d middle, Vec3d right, Vec3d up) {
        all.push_back(view(std::move(name), makeLensSystem, p, size, sheet(middle, right, up)));
    };
    LensSystemParams p = lens("double-gauss", 4);
    add("double Gauss", p, {0, 0, -1.5}, {0.62, 0, 0.1}, {0, 0.42, 0.05});
    p.blades = 6;
    p.bladeRotation = 0.2;
    add("double Gauss with blades, close by", p, {0, 0, -0.25}, {0.11, 0, 0.01}, {0, 0.08, 0});
    p = lens("double-gauss", 2.1);
    p.sensor = {0.05, 0.034};
    add("double Gauss that cuts the corners", p, {0, 0, -1.2}, {0.75, 0, 0}, {0, 0.5, 0.1});
    add("singlet with its stop in front", lens("singlet", 11), {0, 0, -1.5}, {0.62, 0, 0.1}, {0, 0.42, 0.05});
    add("fast Gauss, far away", lens("fast-gauss", 2), {0, 0, -300}, {120, 0, 10}, {0, 80, 0});
}

inline const std::vector<View>& views() {
    static const std::vector<View> all = [] {
        std::vector<View> v;
        addPerspectives(v);
        addOthers(v);
        addHeld(v);
        addLensSystems(v);
        return v;
    }();
    return all;
}

} // namespace abbe::test

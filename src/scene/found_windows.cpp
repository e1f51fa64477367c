// Windows that nobody stated: where paths leave the room that a camera is in. Whatever is found here is right, since
// windows change the noise alone (lights/window_light.h).
#include "lights/daylight_light.h"
#include "lights/environment_light.h"
#include "lights/sky_light.h"
#include "lights/sun_light.h"
#include "lights/window_light.h"
#include "math/hash.h"
#include "math/warp.h"
#include "scene/light_builder.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr std::size_t kFirstLook = 4096; // vertices, after which it is known whether this is a room
constexpr std::size_t kMostVertices = 150000;
constexpr std::size_t kEnough = 4000; // ways out
constexpr double kOpen = 0.25;        // of the rays, more of which leave a place that is no room
constexpr double kBeyond = 0.04;      // of the vertices lie farther out than each wall: in reveals, outside
constexpr double kLeastWindow = 0.01; // of the ways out
constexpr double kMostMissed = 0.05;
constexpr int kCells = 32; // along each side of a wall

struct Way {
    Vec3 from, direction;
};

// Walks of even reflection from what the camera sees.
struct Walks {
    std::vector<Vec3> places, normals;
    std::vector<Way> out;
};

Walks walksFrom(const Scene& scene) {
    Walks walks;
    const PixelBounds& frame = scene.frame;
    for (std::uint64_t path = 0; path < kMostVertices && walks.places.size() < kMostVertices; ++path) {
        if (walks.places.size() >= kFirstLook &&
            (walks.out.size() < walks.places.size() / 1000 || walks.out.size() > kEnough ||
             static_cast<double>(walks.out.size()) > kOpen * static_cast<double>(walks.places.size())))
            break;
        if (path > 4 * kFirstLook && walks.places.size() < kFirstLook) break; // next to nothing is in view
        RandomStream random(combine64(0x77696e646f77, path));
        CameraSample sample;
        sample.film = {static_cast<float>(frame.x0) + random.uniform() * static_cast<float>(frame.width()),
                       static_cast<float>(frame.y0) + random.uniform() * static_cast<float>(frame.height())};
        sample.lens = {random.uniform(), random.uniform()};
        const CameraRay camera = scene.camera->ray(sample);
        Ray ray = camera.ray;
        SurfaceHit hit;
        if (!(camera.weight > 0) || !scene.intersector->intersect(ray, hit)) continue;
        for (int bounce = 0; bounce < 32; ++bounce) {
            const Vec3 n = dot(ray.direction, hit.ng) > 0 ? -hit.ng : hit.ng;
            walks.places.push_back(hit.p);
            walks.normals.push_back(n);
            const Vec3 w =
                normalize(Frame::fromNormal(n).toWorld(squareToCosineHemisphere({random.uniform(), random.uniform()})));
            ray = {spawnOrigin(hit, w), w, kInfinity, ray.time, RayKind::scattered};
            if (scene.intersector->intersect(ray, hit)) continue;
            walks.out.push_back({ray.origin, w});
            break;
        }
    }
    return walks;
}

Vec3 alongAxis(int axis, float length) {
    return {axis == 0 ? length : 0, axis == 1 ? length : 0, axis == 2 ? length : 0};
}

// The box of most vertices, whose sides lie along most walls.
Room roomAround(const Walks& walks, bool zUp) {
    const Vec3 up = zUp ? Vec3{0, 0, 1} : Vec3{0, 1, 0}, east{1, 0, 0}, third = cross(up, east);
    double c = 0, s = 0; // walls a quarter turn apart are the same
    for (const Vec3 n : walks.normals) {
        if (std::abs(dot(n, up)) > 0.5f) continue;
        const double turn = 4 * std::atan2(static_cast<double>(dot(n, third)), static_cast<double>(dot(n, east)));
        c += std::cos(turn);
        s += std::sin(turn);
    }
    const auto turn = static_cast<float>(std::atan2(s, c) / 4);
    Room room;
    room.axes = {east * std::cos(turn) + third * std::sin(turn), third * std::cos(turn) - east * std::sin(turn), up};
    std::vector<float> along(walks.places.size());
    std::array<Vec3, 2> corners;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < along.size(); ++i) along[i] = room.axes.toLocal(walks.places[i])[axis];
        const auto beyond = static_cast<std::ptrdiff_t>(kBeyond * static_cast<double>(along.size()));
        std::nth_element(along.begin(), along.begin() + beyond, along.end());
        corners[0] += alongAxis(axis, along[static_cast<std::size_t>(beyond)]);
        std::nth_element(along.begin(), along.end() - 1 - beyond, along.end());
        corners[1] += alongAxis(axis, *(along.end() - 1 - beyond));
    }
    room.box = {corners[0], corners[1]};
    return room;
}

// One side of the box, and where ways out cross it.
class Wall {
  public:
    Wall(const Room& room, int axis, bool upper) : room_(room), axis_(axis), upper_(upper) {}

    void addCrossing(Vec3 local) {
        const float a = local[(axis_ + 1) % 3], b = local[(axis_ + 2) % 3];
        crossings_.push_back({a, b});
        cells_[cell(a, b)].push_back(crossings_.size() - 1);
    }
    // Corners of the rectangle around each group of cells that touch, if it has enough of the ways out. Returns how
    // many they are.
    std::size_t findWindows(std::size_t least, std::vector<std::array<Vec3d, 4>>& result);

  private:
    float lower(int side) const { return room_.box.lower[(axis_ + side) % 3]; }
    float upper(int side) const { return room_.box.upper[(axis_ + side) % 3]; }
    std::size_t cell(float a, float b) const {
        const auto along = [&](float x, int side) {
            const float u = (x - lower(side)) / (upper(side) - lower(side));
            return static_cast<std::size_t>(std::clamp(static_cast<int>(u * kCells), 0, kCells - 1));
        };
        return along(a, 1) * kCells + along(b, 2);
    }
    std::vector<std::size_t> takeGroup(std::size_t start); // crossings; its cells are empty after
    std::array<Vec3d, 4> rectangleAround(const std::vector<std::size_t>& crossings) const;

    const Room& room_;
    int axis_;
    bool upper_;
    std::vector<Vec2> crossings_;
    std::array<std::vector<std::size_t>, kCells * kCells> cells_;
};

std::vector<std::size_t> Wall::takeGroup(std::size_t start) {
    std::vector<std::size_t> group, open{start};
    while (!open.empty()) {
        const std::size_t at = open.back();
        open.pop_back();
        if (cells_[at].empty()) continue;
        group.insert(group.end(), cells_[at].begin(), cells_[at].end());
        cells_[at].clear();
        const int row = static_cast<int>(at) / kCells, column = static_cast<int>(at) % kCells;
        for (int r = std::max(row - 1, 0); r <= std::min(row + 1, kCells - 1); ++r)
            for (int c = std::max(column - 1, 0); c <= std::min(column + 1, kCells - 1); ++c)
                open.push_back(static_cast<std::size_t>(r * kCells + c));
    }
    return group;
}

std::size_t Wall::findWindows(std::size_t least, std::vector<std::array<Vec3d, 4>>& result) {
    std::size_t found = 0;
    for (std::size_t start = 0; start < cells_.size(); ++start) {
        const std::vector<std::size_t> group = takeGroup(start);
        if (group.size() < least || result.size() == Portals::kMost) continue;
        const auto corners = rectangleAround(group);
        if (!Portal::isRectangle(corners)) continue;
        found += group.size();
        result.push_back(corners);
    }
    return found;
}

// A little wider, as the rim is seldom met.
std::array<Vec3d, 4> Wall::rectangleAround(const std::vector<std::size_t>& group) const {
    Vec2 from{kInfinity, kInfinity}, to{-kInfinity, -kInfinity};
    for (const std::size_t i : group) {
        from = {std::min(from.x, crossings_[i].x), std::min(from.y, crossings_[i].y)};
        to = {std::max(to.x, crossings_[i].x), std::max(to.y, crossings_[i].y)};
    }
    const float rim = 2 / std::sqrt(static_cast<float>(group.size()));
    const Vec2 wider{(to.x - from.x) * std::min(rim, 0.04f), (to.y - from.y) * std::min(rim, 0.04f)};
    const Vec2 first{std::max(from.x - wider.x, lower(1)), std::max(from.y - wider.y, lower(2))};
    const Vec2 last{std::min(to.x + wider.x, upper(1)), std::min(to.y + wider.y, upper(2))};
    const auto corner = [&](float a, float b) {
        const Vec3 local = alongAxis(axis_, upper_ ? upper(0) : lower(0)) + alongAxis((axis_ + 1) % 3, a) +
                           alongAxis((axis_ + 2) % 3, b);
        return Vec3d(room_.axes.toWorld(local));
    };
    std::array<Vec3d, 4> corners{corner(first.x, first.y), corner(last.x, first.y), corner(last.x, last.y),
                                 corner(first.x, last.y)};
    const Vec3 inwards = alongAxis(axis_, upper_ ? -1.f : 1.f);
    if (dot(cross(corners[1] - corners[0], corners[3] - corners[0]), Vec3d(room_.axes.toWorld(inwards))) < 0)
        std::swap(corners[1], corners[3]);
    return corners;
}

// None where this is no room, or where light enters it in so many places that windows would not tell.
std::vector<std::array<Vec3d, 4>> windowsOf(const Room& room, const Walks& walks) {
    std::vector<Wall> walls;
    for (int side = 0; side < 6; ++side) walls.emplace_back(room, side / 2, side % 2 == 1);
    std::size_t ways = 0;
    for (const Way& way : walks.out) {
        if (!room.contains(way.from)) continue;
        const Vec3 p = room.axes.toLocal(way.from), w = room.axes.toLocal(way.direction);
        float nearest = kInfinity;
        int side = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (w[axis] == 0) continue;
            const float t = std::max(((w[axis] > 0 ? room.box.upper : room.box.lower)[axis] - p[axis]) / w[axis], 0.f);
            if (t < nearest) {
                nearest = t;
                side = 2 * axis + (w[axis] > 0 ? 1 : 0);
            }
        }
        walls[static_cast<std::size_t>(side)].addCrossing(p + w * nearest);
        ++ways;
    }
    std::vector<std::array<Vec3d, 4>> windows;
    std::size_t found = 0;
    const auto least = std::max<std::size_t>(8, static_cast<std::size_t>(kLeastWindow * static_cast<double>(ways)));
    for (Wall& wall : walls) found += wall.findWindows(least, windows);
    const bool enough = static_cast<double>(found) >= (1 - kMostMissed) * static_cast<double>(ways);
    return ways >= 64 && enough ? windows : std::vector<std::array<Vec3d, 4>>{};
}

// Whether a sun shines into the room through these windows alone.
bool entersThrough(const Portals& windows, const Light& sun, const Scene& scene, const Walks& walks) {
    std::size_t lit = 0, beside = 0;
    RandomStream random(0x73756e);
    for (std::size_t i = 0; i < walks.places.size(); i += 4) {
        if (!windows.inside(walks.places[i])) continue;
        const auto s = sun.sample(walks.places[i], 0, {random.uniform(), random.uniform()}, Wavelengths::sample(0), 0);
        if (!s || dot(s->wi, walks.normals[i]) <= 0.01f) continue;
        const Vec3 from = walks.places[i] + walks.normals[i] * (1e-4f * length(walks.places[i]));
        if (scene.intersector->occluded({from, s->wi})) continue;
        ++lit;
        beside += !windows.cross(walks.places[i], s->wi);
    }
    return beside * 100 <= lit;
}

bool isSky(const Light& light) {
    return dynamic_cast<const SkyLight*>(&light) || dynamic_cast<const DaylightSky*>(&light) ||
           dynamic_cast<const EnvironmentLight*>(&light);
}

} // namespace

void LightBuilder::findWindows() {
    Scene& scene = context_.built.scene;
    const bool stated = std::ranges::any_of(lights_, [](const auto& l) { return dynamic_cast<WindowLight*>(l.get()); });
    const bool skies = std::ranges::any_of(lights_, [](const auto& l) { return isSky(*l); });
    const RenderParams& how = context_.built.render;
    if (stated || !skies || !scene.camera || how.strategy != Technique::Strategy::mis ||
        how.windows != Technique::Windows::automatic)
        return;
    const Walks walks = walksFrom(scene);
    const auto vertices = static_cast<double>(walks.places.size());
    if (walks.places.size() < kFirstLook || static_cast<double>(walks.out.size()) > kOpen * vertices) return;
    const Room room = roomAround(walks, context_.tree.header.zUp);
    const auto windows = windowsOf(room, walks);
    if (windows.empty()) return;
    const Portals* shown = nullptr;
    for (auto& light : lights_) {
        if (!isSky(*light)) continue;
        auto name = scene.names.extract(light.get());
        const Visibility visible = light->visible();
        std::unique_ptr<DistantLight> sky(static_cast<DistantLight*>(light.release()));
        auto through = std::make_unique<WindowLight>(std::move(sky), windows, room);
        through->setVisible(visible);
        shown = &through->portals();
        if (name) {
            name.key() = through.get();
            scene.names.insert(std::move(name));
        }
        light = std::move(through);
    }
    for (auto& light : lights_)
        if (auto* const sun = dynamic_cast<SunLight*>(light.get()); sun && entersThrough(*shown, *sun, scene, walks))
            sun->lookThrough(*shown);
}

} // namespace abbe

#include "render/camera.h"
#include "render/light.h"
#include "scene_checks/checks.h"
#include "scene_checks/wording.h"
#include "schema/unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>

namespace abbe::checks {

namespace {

constexpr std::array<std::string_view, 5> kLengthUnits = {"um", "mm", "cm", "m", "km"};

// Whoever writes `km` or `um` knows how large it is.
bool writesUnit(const schema::Document& document) {
    return std::ranges::any_of(document.values, [](const schema::Value& value) {
        if (value.kind != schema::ValueKind::word || value.text == "m") return false;
        const auto unit = schema::findUnit(value.text);
        return unit && unit->dimension == schema::Dimension::length;
    });
}

bool statesLengths(const schema::SceneTree& tree) {
    if (tree.document && writesUnit(*tree.document)) return true;
    return std::ranges::any_of(
        tree.inserts, [](const auto& insert) { return insert.second.written && writesUnit(*insert.second.document); });
}

struct UnitGuess {
    std::string_view unit;
    double length = 0; // m, of the same number in it
};

// The unit in which a length that was counted in `perUnit` metres comes nearest to `wanted`, in decades.
std::optional<UnitGuess> guessUnit(double length, double perUnit, double wanted) {
    std::optional<UnitGuess> best;
    double least = 1; // decades: worse is no guess
    for (const std::string_view name : kLengthUnits) {
        const double scale = schema::findUnit(name)->scale, guessed = length / perUnit * scale;
        const double decades = std::abs(std::log10(guessed / wanted));
        if (scale == perUnit || !(decades < least)) continue;
        least = decades;
        best = UnitGuess{name, guessed};
    }
    return best;
}

double diagonalOf(const Bounds3d& box) { return length(box.upper - box.lower); }

double distanceTo(const Bounds3d& box, Vec3d p) {
    const Vec3d outside = max(max(box.lower - p, p - box.upper), Vec3d{0, 0, 0});
    return length(outside);
}

// Of the scene; nothing without finite geometry.
std::optional<Bounds3d> boundsOf(const BuiltScene& built) {
    const Bounds3d& box = built.facts.bounds;
    return box.empty() || !std::isfinite(diagonalOf(box)) ? std::nullopt : std::optional(box);
}

Vec3d eyeOf(const BuiltScene& built) { return Vec3d(built.scene.eye) + built.scene.origin; }

} // namespace

void checkExtent(const BuiltScene& built, const schema::SceneTree& tree, Diagnostics& diagnostics) {
    constexpr double kLargest = 1e7, kSmallest = 1e-5, kUsual = 5; // m
    const auto box = boundsOf(built);
    const double size = box ? diagonalOf(*box) : kUsual;
    if ((size <= kLargest && size >= kSmallest) || size == 0 || statesLengths(tree)) return;
    const auto byExtent = [](const auto& fact) {
        const double extent = fact.bounds.empty() ? 0 : diagonalOf(fact.bounds);
        return std::isfinite(extent) ? extent : 0;
    };
    const auto& shapes = built.facts.shapeList;
    const auto widest = std::ranges::max_element(shapes, {}, byExtent);
    auto& warning =
        diagnostics.warning("W0610", tree.header.span, fmt::format("the scene is {} across", lengthText(size)),
                            fmt::format("a bare number counts in {}", lengthText(tree.header.length)));
    if (widest != shapes.end() && !widest->name.empty())
        warning.notes.push_back(fmt::format("`{}` alone is {}", widest->name, lengthText(byExtent(*widest))));
    if (const auto guess = guessUnit(size, tree.header.length, kUsual))
        warning.help = fmt::format("with `scene {} length={}` it is {}", tree.header.edition, guess->unit,
                                   lengthText(guess->length));
    else
        warning.help = "if that is meant, write units behind the numbers: `radius 6371 km`";
}

namespace {

// Two rays of the film's middle line and how far apart they are at distance 1: the width of the picture there.
double widthAtOne(const BuiltScene& built) {
    const Camera& camera = *built.scene.camera;
    const auto width = static_cast<float>(built.film.size.x), middle = static_cast<float>(built.film.size.y) / 2;
    const CameraRay left = camera.ray({{0.5f, middle}, {0.5f, 0.5f}});
    const CameraRay right = camera.ray({{width - 0.5f, middle}, {0.5f, 0.5f}});
    return static_cast<double>(length(left.ray.direction - right.ray.direction));
}

} // namespace

void checkCameraDistance(const BuiltScene& built, const schema::SceneTree& tree, Diagnostics& diagnostics) {
    constexpr double kFar = 1000, kDot = 0.05; // of the scene's size; of the picture's width
    const auto box = boundsOf(built);
    if (!box || !built.scene.camera || !(diagonalOf(*box) > 0)) return;
    const double size = diagonalOf(*box), distance = distanceTo(*box, eyeOf(built));
    if (distance <= kFar * size || size >= kDot * distance * widthAtOne(built)) return;
    auto& warning = diagnostics.warning(
        "W0611", built.cameraSpan,
        fmt::format("the camera is {} away from a scene that is {} across", lengthText(distance), lengthText(size)),
        "the scene is a dot from here");
    if (const auto guess = guessUnit(distance, tree.headerOf(built.cameraSpan).length, 2 * size))
        warning.help = fmt::format("is its place in {}? Then it is {} away: write the unit behind `from`", guess->unit,
                                   lengthText(guess->length));
    else
        warning.help = "look at the units of `from` and of what the scene's files are in (`scale`)";
}

void checkLampPowers(const BuiltScene& built, Diagnostics& diagnostics) {
    constexpr double kMost = 1e7, kCelestial = 1e5, kLarge = 100; // W, m, m
    for (const auto& light : built.scene.lights) {
        const double watts = light->power();
        if (light->infinite() || light->emission() || !(watts > kMost)) continue;
        Bounds3 box;
        for (std::uint32_t part = 0; part < light->parts(); ++part)
            if (const auto bounds = light->bounds(part)) box.add(bounds->box);
        const double size = box.empty() ? 0 : static_cast<double>(length(box.diagonal()));
        if (size > kCelestial) continue;
        auto& warning = diagnostics.warning("W0612", placeOf(light.get(), built),
                                            fmt::format("{} gives off {:.3g} W", quotedName(light.get(), built), watts),
                                            "as much as a power station");
        if (size > kLarge)
            warning.help =
                fmt::format("it is {} across: with `scene 1 length=mm` bare numbers are millimetres", lengthText(size));
        else
            warning.help =
                "film lamps have up to 20 kW; `mW`, `W`, `kW` are radiant power, `lm` counts light as people see "
                "it (a bulb has 800 lm)";
    }
}

namespace {

// How wide the picture of a point is at a distance along the middle ray, as a share of the picture's width there.
class Blur {
  public:
    explicit Blur(const BuiltScene& built) {
        const Camera& camera = *built.scene.camera;
        const Vec2 middle{static_cast<float>(built.film.size.x) / 2, static_cast<float>(built.film.size.y) / 2};
        axis_ = camera.ray({middle, {0.5f, 0.5f}}).ray;
        for (const float u : {0.f, 0.25f, 0.5f, 0.75f})
            for (const float r : {0.95f, 0.99f}) {
                const CameraRay ray = camera.ray({middle, {r, u}});
                if (ray.weight > 0) rays_.push_back(ray.ray);
                const CameraRay other = camera.ray({middle, {u, r}});
                if (other.weight > 0) rays_.push_back(other.ray);
            }
        width_ = widthAtOne(built);
    }

    bool known() const { return rays_.size() >= 2 && width_ > 0 && width_ < 1.9; } // no panorama
    const Ray& axis() const { return axis_; }
    double at(double distance) const {
        double widest = 0;
        for (const Ray& a : rays_)
            for (const Ray& b : rays_) widest = std::max(widest, length(onPlane(a, distance) - onPlane(b, distance)));
        return widest / (distance * width_);
    }
    // Where all rays of the middle meet; infinite where they are parallel. By thirds of an interval of the logarithm,
    // in which the width has one minimum.
    double focus() const {
        constexpr double kNearest = -4, kFarthest = 8; // powers of ten, m
        double from = kNearest, to = kFarthest;
        while (to - from > 1e-6) {
            const double a = from + (to - from) / 3, b = to - (to - from) / 3;
            if (at(std::pow(10.0, a)) < at(std::pow(10.0, b)))
                to = b;
            else
                from = a;
        }
        return to > kFarthest - 0.1 ? kNever : std::pow(10.0, (from + to) / 2);
    }

  private:
    static constexpr double kNever = std::numeric_limits<double>::infinity();

    Vec3d onPlane(const Ray& ray, double distance) const {
        const Vec3d n(axis_.direction), o(ray.origin), d(ray.direction);
        const double t = (distance - dot(o - Vec3d(axis_.origin), n)) / dot(d, n);
        return o + d * t;
    }

    Ray axis_;
    std::vector<Ray> rays_;
    double width_ = 0;
};

// Distances along the axis between which the scene lies in front of the camera.
std::optional<std::pair<double, double>> depthsOf(const Bounds3d& box, const Ray& axis, Vec3d origin) {
    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p{corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                      corner & 4 ? box.upper.z : box.lower.z};
        const double depth = dot(p - origin - Vec3d(axis.origin), Vec3d(axis.direction));
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    if (!(farthest > 0)) return std::nullopt;
    return std::pair(std::max(nearest, 0.0), farthest);
}

} // namespace

void checkFocus(const BuiltScene& built, const schema::SceneTree& tree, Diagnostics& diagnostics) {
    constexpr double kBlurred = 0.2; // of the picture's width
    const auto box = boundsOf(built);
    if (!box || !built.scene.camera || !built.scene.camera->usesLens()) return;
    const Blur blur(built);
    const auto depths = blur.known() ? depthsOf(*box, blur.axis(), built.scene.origin) : std::nullopt;
    if (!depths) return;
    const double focus = blur.focus();
    const double sharpest = std::clamp(focus, depths->first, depths->second);
    if (!(sharpest > 0) || focus == sharpest || blur.at(sharpest) < kBlurred) return;
    const double share = std::min(blur.at(sharpest), 9.99);
    auto& warning = diagnostics.warning("W0613", built.cameraSpan, "nothing of the scene is in focus",
                                        fmt::format("the lens is sharp at {}", lengthText(focus)));
    warning.notes.push_back(
        fmt::format("the scene lies between {} and {} from it; at best a point is blurred over {:.0f} % "
                    "of the picture's width",
                    lengthText(depths->first), lengthText(depths->second), 100 * share));
    const auto guess = guessUnit(focus, tree.headerOf(built.cameraSpan).length,
                                 std::sqrt(std::max(depths->first, depths->second / 100) * depths->second));
    const bool fits = guess && guess->length >= 0.9 * depths->first && guess->length <= 1.1 * depths->second;
    warning.help =
        fits ? fmt::format("is `focus` meant in {}? Then it is sharp at {}", guess->unit, lengthText(guess->length))
             : "`focus on=NAME` is sharp at a shape; a larger `f-stop` is sharp in more depth";
}

} // namespace abbe::checks

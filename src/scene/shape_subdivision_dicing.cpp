#include "base/diagnostic.h"
#include "math/bounds.h"
#include "scene/camera_builder.h"
#include "scene/registry.h"
#include "scene/shape_subdivision.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace abbe {

namespace {

std::string millions(std::uint64_t n) {
    return n < 1'000'000 ? fmt::format("{} triangles", n)
                         : fmt::format("{:.1f} million triangles", static_cast<double>(n) * 1e-6);
}

} // namespace

std::optional<Dicing> dicingOf(const schema::Quantity& q, Diagnostics& diagnostics) {
    Dicing dicing;
    dicing.rate = q.value;
    dicing.mode = q.dimension == schema::Dimension::pixels   ? Dicing::Mode::pixels
                  : q.dimension == schema::Dimension::length ? Dicing::Mode::length
                                                             : Dicing::Mode::level;
    const bool level = dicing.mode == Dicing::Mode::level;
    if (!q.keys.empty() && dicing.mode != Dicing::Mode::pixels) {
        diagnostics.error("E0210", q.span, "`camera=` belongs to `dicing` in pixels", "no pixels are measured here")
            .help = "write `dicing 0.5 px camera=main`, or leave it out";
        return std::nullopt;
    }
    if (level && (q.value != std::floor(q.value) || q.value > SubdivisionSurface::kMaxLevel)) {
        diagnostics
            .error("E0303", q.span, "without a unit `dicing` is a level, a whole number from 0 to 10",
                   fmt::format("is {:g}", q.value))
            .help = "for the length of edges write `dicing 0.5 px` or `dicing 2 mm`";
        return std::nullopt;
    }
    if (!level && !(q.value > 0)) {
        diagnostics.error("E0303", q.span, "`dicing` must be above 0", "is 0");
        return std::nullopt;
    }
    return dicing;
}

std::string describe(const DicingPlan& plan) {
    return fmt::format("{} in {:.0f} MiB", millions(plan.triangles), static_cast<double>(plan.bytes) / (1 << 20));
}

void warnOfBudget(const SubdivisionSurface& surface, const Dicing& dicing, const DicingPlan& plan, double memory,
                  Span span, Diagnostics& diagnostics, const Displacement* displacement) {
    const DicingPlan asked = surface.plan(dicing, ~std::uint64_t{0}, displacement);
    const std::string rate = dicing.mode == Dicing::Mode::level
                                 ? fmt::format("level {:g} instead of {:g}",
                                               std::max(0.0, dicing.rate - std::log2(plan.coarser)), dicing.rate)
                             : dicing.mode == Dicing::Mode::pixels
                                 ? fmt::format("{:.3g} px instead of {:g} px", dicing.rate * plan.coarser, dicing.rate)
                                 : fmt::format("{:.3g} m instead of {:g} m", dicing.rate * plan.coarser, dicing.rate);
    diagnostics
        .warning("W0661", span,
                 fmt::format("`dicing` would make {}, more than the {:g} MiB of `memory`", describe(asked), memory),
                 fmt::format("diced at {}: {}", rate, describe(plan)))
        .help = "raise `memory`, or ask for coarser `dicing`";
}

// How large a pixel is where a surface is diced, as the render camera or a named one sees it.

namespace {

// What a camera sees, roughly: all within an angle about its axis, from anywhere within a radius of its place. It
// encloses the rays through the rim of the picture while the shutter is open.
class ViewCone {
  public:
    ViewCone(const Camera& camera, Vec2d film, const Ray& axis) : from_(axis.origin), axis_(axis.direction) {
        double cosine = 1;
        const int steps = 8; // on each side
        for (const float time : {0.f, 0.5f, 1.f})
            for (int i = 0; i < 4 * steps; ++i) {
                const double along = static_cast<double>(i % steps) / steps;
                const int side = i / steps;
                const Vec2d at = side == 0   ? Vec2d{along, 0}
                                 : side == 1 ? Vec2d{1, along}
                                 : side == 2 ? Vec2d{1 - along, 1}
                                             : Vec2d{0, 1 - along};
                CameraSample sample;
                sample.film = {static_cast<float>(at.x * film.x), static_cast<float>(at.y * film.y)};
                sample.lens = {0.5f, 0.5f};
                sample.time = time;
                const CameraRay r = camera.ray(sample);
                if (!(r.weight > 0)) continue; // a dark corner of the lens
                cosine = std::min(cosine, dot(Vec3d(r.ray.direction), axis_));
                spread_ = std::max(spread_, length(Vec3d(r.ray.origin) - from_));
            }
        all_ = !(cosine > 0.1); // a fisheye, a panorama
        angle_ = kMargin * std::acos(std::clamp(cosine, -1.0, 1.0)) + kPiD / 180;
    }

    void addTo(DigestWriter& writer) const {
        writer.add(from_), writer.add(axis_);
        writer.number(spread_), writer.number(angle_), writer.number(all_);
    }

    // 0 for what is seen, or nearly; 1 for what is far outside or behind.
    double outside(Vec3d p) const {
        if (all_) return 0;
        const Vec3d v = p - from_;
        const double along = dot(v, axis_);
        const double across = std::max(0.0, length(v - axis_ * along) - kMargin * spread_);
        return std::clamp((std::atan2(across, along) - angle_) / kRamp, 0.0, 1.0);
    }

  private:
    static constexpr double kMargin = 1.1;
    static constexpr double kRamp = kPiD / 6;
    Vec3d from_, axis_;
    double spread_ = 0, angle_ = 0;
    bool all_ = false;
};

void unknownCamera(const schema::SceneTree& tree, std::string_view name, Span span, Diagnostics& diagnostics) {
    std::vector<std::string_view> names;
    for (const schema::Definition& d : tree.definitions)
        if (d.kind == schema::Kind::camera && !d.name.empty()) names.push_back(d.name);
    const auto meant = schema::nearest(name, names);
    diagnostics
        .error("E0202", span, fmt::format("no camera is named `{}`", name),
               meant.empty() ? "unknown name" : schema::didYouMean(meant))
        .help = names.empty() ? "no camera of this scene has a name: `camera main { … }`"
                              : "the cameras are " + schema::quotedList(names);
}

} // namespace

namespace {

// The size of a pixel in the middle of the film, and what the film sees.
struct PixelView {
    Vec3d from, shift, turn; // from one pixel to the next, origin and direction of rays move by so much
    ViewCone cone;

    static PixelView of(const Camera& camera, Vec2d filmSize) {
        CameraSample sample;
        sample.film = {static_cast<float>(filmSize.x / 2), static_cast<float>(filmSize.y / 2)};
        sample.lens = {0.5f, 0.5f};
        const CameraRay a = camera.ray(sample);
        sample.film.x += 1;
        const CameraRay b = camera.ray(sample);
        return {Vec3d(a.ray.origin), Vec3d(b.ray.origin) - Vec3d(a.ray.origin),
                Vec3d(b.ray.direction) - Vec3d(a.ray.direction), ViewCone(camera, filmSize, a.ray)};
    }
};

} // namespace

std::function<double(Vec3)> pixelSizeOf(const Camera& camera, Vec2d filmSize, double offscreen) {
    return [view = PixelView::of(camera, filmSize), offscreen](Vec3 p) {
        const double size = length(view.shift + view.turn * length(Vec3d(p) - view.from));
        return size * (1 + (offscreen - 1) * view.cone.outside(Vec3d(p)));
    };
}

// The definition of the camera that dicing is measured by: null with an error, or for the render camera.
bool CameraBuilder::checkDicingCamera(const schema::Quantity& dicing) {
    for (const auto& [key, name] : dicing.keys)
        if (!context_.tree.find(schema::Kind::camera, name, dicing.span)) {
            unknownCamera(context_.tree, name, dicing.span, context_.diagnostics);
            return false;
        }
    return true;
}

// Nothing while the camera itself is being made, because it asks where the shape is, and after an error in it.
std::optional<CameraBuilder::DicingCamera> CameraBuilder::dicingCamera(const schema::Quantity& dicing) {
    const auto renderCamera = [&]() -> std::optional<DicingCamera> {
        if (!context_.built.scene.camera) return std::nullopt;
        return DicingCamera{context_.built.scene.camera.get(), {}};
    };
    if (dicing.keys.empty()) return renderCamera();
    const Definition* d = context_.tree.find(schema::Kind::camera, dicing.keys[0].second, dicing.span);
    if (!d || d == context_.only(schema::Kind::camera, context_.options.camera)) return renderCamera();
    const auto [found, isNew] = dicingCameras_.try_emplace(d);
    if (isNew && d->type) {
        const auto bindInto = context_.binder(*d, context_.diagnostics);
        if (auto placed = makerOf<MakeCamera>(*d->type)(bindInto, contextOf(*d), context_.diagnostics))
            found->second = std::make_unique<const PlacedCamera>(std::move(*placed));
    }
    if (!found->second) return std::nullopt;
    return DicingCamera{found->second->camera.get(), context_.built.scene.origin - found->second->origin};
}

Dicing CameraBuilder::dicingFor(Dicing dicing, const schema::Quantity& asked, double offscreen,
                                const SubdivisionCage& cage, const Transform& place, bool inObject) {
    if (dicing.mode != Dicing::Mode::pixels) return dicing;
    const auto camera = dicingCamera(asked);
    if (!camera) {
        dicing.mode = Dicing::Mode::level;
        dicing.rate = 2;
    } else if (inObject) {
        Bounds3d box;
        for (const Vec3 p : cage.positions) box.add(place.point(Vec3d(p)));
        dicing.pixelSize = [size = length(box.upper - box.lower) / context_.built.film.size.y](Vec3) { return size; };
    } else {
        dicing.pixelSize = [size = pixelSizeOf(*camera->camera, context_.built.film.size, offscreen),
                            shift = camera->toCamera](Vec3 p) { return size(Vec3(Vec3d(p) + shift)); };
    }
    return dicing;
}

void CameraBuilder::addView(DigestWriter& writer, const Dicing& dicing, const schema::Quantity& asked, double offscreen,
                            bool inObject) {
    if (dicing.mode != Dicing::Mode::pixels) return;
    const auto camera = dicingCamera(asked);
    writer.number(camera.has_value());
    writer.number(offscreen);
    if (!camera) return;
    const Vec2d film = context_.built.film.size;
    if (inObject) return writer.number(film.y);
    const PixelView view = PixelView::of(*camera->camera, film);
    writer.add(view.from), writer.add(view.shift), writer.add(view.turn), writer.add(camera->toCamera);
    view.cone.addTo(writer);
}

namespace {

// Tiles without a file that faces of the cage lie in, by the middle of the face.
std::set<int> uncoveredTiles(const SubdivisionCage& cage, const Texture& map) {
    std::set<int> tiles;
    std::size_t first = 0;
    for (const std::uint32_t size : cage.faceSizes) {
        Vec2 sum;
        for (std::size_t i = 0; i < size; ++i) sum = sum + cage.uvs[cage.uvCorners[first + i]];
        first += size;
        const Vec2 middle = sum * (1 / static_cast<float>(size));
        if (!map.covers(middle))
            tiles.insert(1001 + static_cast<int>(std::floor(middle.x)) + 10 * static_cast<int>(std::floor(middle.y)));
    }
    return tiles;
}

bool fits(const Displacement& d, const SubdivisionCage& cage, Span span, Diagnostics& diagnostics) {
    if (d.map->channels() < d.channels()) {
        diagnostics.error("E0671", span, "a vector displacement needs a map with three channels", "the map has one");
        return false;
    }
    const bool image = d.map->needsUv();
    if (!image && d.space != Displacement::Space::tangent) return true;
    if (cage.uvCorners.empty()) {
        diagnostics
            .error("E0670", span,
                   image ? "an image displaces along texture coordinates, and this cage has none"
                         : "a displacement in tangent space needs texture coordinates, and this cage has none",
                   "nothing says where the map lies")
            .help = "give the cage `vt` in its OBJ file or `uvs`, or displace with `map noise`, which needs none";
        return false;
    }
    const std::set<int> missing = uncoveredTiles(cage, *d.map);
    if (missing.empty()) return true;
    diagnostics.error(
        "E0672", span, fmt::format("the map has no tile {}", *missing.begin()),
        missing.size() == 1
            ? "faces of this shape lie in it"
            : fmt::format("faces of this shape lie in it and in {} others that are missing", missing.size() - 1));
    return false;
}

} // namespace

std::optional<DisplacementChoice> chooseDisplacement(const DisplacementParams& p, const Texture* map,
                                                     const SubdivisionCage& cage, Diagnostics& diagnostics) {
    DisplacementChoice choice;
    if (!p.displacement) return choice;
    const Span span = p.displacement->span;
    if (!map) {
        if (p.displacementMap.valid()) return std::nullopt; // reported
        diagnostics.error("E0207", span, "`displacement` needs a `map`", "is missing here").help =
            "for example `displacement 2 mm { map noise { scale 1 cm } }`";
        return std::nullopt;
    }
    const bool vector = p.displacementKind && p.displacementKind->word == "vector";
    if (p.displacementSpace && !vector) {
        diagnostics.error("E0310", span, "`space` belongs to vector displacement", "this one is scalar").help =
            "write `kind vector`, or leave `space` out: a scalar moves along the normal";
        return std::nullopt;
    }
    Displacement& d = choice.displacement;
    d.space = !vector                                                        ? Displacement::Space::normal
              : p.displacementSpace && p.displacementSpace->word == "object" ? Displacement::Space::object
                                                                             : Displacement::Space::tangent;
    d.amount = p.displacement->value;
    d.midpoint = p.midpoint.value_or(vector ? 0 : 0.5);
    d.map = map;
    choice.moves = d.amount != 0;
    if (!fits(d, cage, span, diagnostics)) return std::nullopt;
    return choice;
}

} // namespace abbe

#include "exchange/stated/export.h"

#include "exchange/stated/stated_spectra.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

void Export::leftOut(Span span, std::string_view what, std::string_view why) {
    diagnostics.warning("W0801", span, fmt::format("{} is left out: {}", what, why));
    remarks_.push_back(fmt::format("Left out: {}: {}", what, why));
}

void Export::approximated(Span span, std::string_view what, std::string_view how) {
    diagnostics.warning("W0802", span, fmt::format("{} is approximated: {}", what, how));
    remarks_.push_back(fmt::format("Approximated: {}: {}", what, how));
}

void Export::leaveOutUnused(const StatedThing& thing) {
    for (const auto& [property, where] : thing.takeUnused())
        if (!property.starts_with("x-"))
            leftOut(where, fmt::format("`{}` of `{}`", property, thing.type.empty() ? thing.name : thing.type),
                    fmt::format("{} has nothing like it", format));
}

void Export::ignore(const StatedThing& thing, std::initializer_list<std::string_view> properties) {
    for (const std::string_view property : properties) thing.has(property);
}

const StatedThing* normalMapOf(const StatedThing& material, Export& to) {
    const auto* const stated = material.value<schema::WeightedReference>("normal");
    if (stated && stated->weight != 1)
        to.approximated(stated->span.valid() ? stated->span : material.span, "`strength=` of a normal map", "it is 1");
    return material.reference("normal");
}

bool canBeInstanced(const std::vector<Placed>& object) {
    return std::ranges::all_of(object, [](const Placed& p) {
        const bool plain = p.visibleTo.empty() && !p.moves; // else something is to be said of each
        return plain && p.thing && p.thing->kind == schema::Kind::shape && !p.thing->spectrum("emission") &&
               !p.thing->reference("interior");
    });
}

namespace {

void unfold(const Placed& instance, const StatedScene& scene, int depth, std::vector<Placed>& out) {
    constexpr int kDeepest = 32;
    if (depth > kDeepest) return;
    for (Placed part : scene.object(instance.object)) {
        part.toWorld = part.toWorld.then(instance.toWorld);
        if (part.thing)
            out.push_back(std::move(part));
        else
            unfold(part, scene, depth + 1, out);
    }
}

} // namespace

std::vector<Placed> unfolded(const Placed& instance, const StatedScene& scene) {
    std::vector<Placed> list;
    unfold(instance, scene, 0, list);
    return list;
}

namespace {

// A camera that is read and written again stands where it stood.
Transform settled(Transform map) {
    const auto cut = [](Transform t) {
        for (int c = 0; c < 3; ++c) {
            const Vec3d column = onGrid({t.a[0][c], t.a[1][c], t.a[2][c]});
            for (int r = 0; r < 3; ++r) t.a[r][c] = column[r];
        }
        return t;
    };
    map = cut(map);
    for (int i = 0; i < 16; ++i) {
        const Vec3d back = map.vector({0, 0, 1});
        const auto read = Transform::lookAt(map.t, map.t - back / length(back), map.vector({0, 1, 0}));
        if (!read) return map;
        const Transform next = cut(*read);
        bool same = true;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) same = same && next.a[r][c] == map.a[r][c];
        map = next;
        if (same) break;
    }
    return map;
}

} // namespace

Vec3d onGrid(Vec3d v) {
    constexpr double kSteps = 1e11;
    const auto cut = [](double x) { return std::abs(x) < 1e4 ? std::round(x * kSteps) / kSteps + 0.0 : x; };
    return {cut(v.x), cut(v.y), cut(v.z)};
}

Transform cameraToWorld(const StatedThing& camera, const StatedScene& scene) {
    if (const auto* keyed = camera.value<KeyedTransform>("transform")) {
        Transform map = keyed->at(camera.number("time", 0));
        const double scale = map.uniformScale().value_or(1);
        for (auto& row : map.a)
            for (double& v : row) v /= scale;
        return map;
    }
    const auto placed = [&](std::string_view name) {
        const auto own = camera.vector(name);
        return own ? own : camera.vector("at." + std::string(name));
    };
    const Vec3d from = placed("from").value_or(Vec3d());
    const Vec3d to = placed("look-at").value_or(from + (scene.zUp() ? Vec3d(0, 1, 0) : Vec3d(0, 0, -1)));
    const Vec3d up = placed("up").value_or(scene.up());
    return settled(Transform::lookAt(from, to, up).value_or(Transform::translate(from)));
}

double halfWidthOf(const StatedThing& camera, Vec2d filmSize) {
    if (camera.type == "orthographic") {
        const auto width = camera.number("width"), height = camera.number("height");
        return width ? *width / 2 : height.value_or(1) / 2 * filmSize.x / filmSize.y;
    }
    if (const auto fov = camera.number("fov")) return std::tan(*fov / 2);
    const double sensor = camera.pair("sensor").value_or(Vec2d(0.036, 0.024)).x * camera.number("squeeze", 1);
    return sensor / (2 * camera.number("lens", 0.05));
}

double lensRadiusOf(const StatedThing& camera) {
    if (const auto aperture = camera.number("aperture")) return *aperture / 2;
    const auto stop = camera.number("f-stop");
    if (!stop || !std::isfinite(*stop)) return 0;
    const double sensor = camera.pair("sensor").value_or(Vec2d(0.036, 0.024)).x * camera.number("squeeze", 1);
    return sensor / (2 * halfWidthOf(camera, {1, 1})) / *stop / 2;
}

double focusOf(const StatedThing& camera, Export& to) {
    const auto* const place = camera.value<schema::Location>("focus");
    if (place && place->distance) return *place->distance;
    if (place && lensRadiusOf(camera) > 0)
        to.approximated(place->span, "`focus on=`", "by the distance of `look-at`; state it as a length");
    const auto at = camera.vector("look-at");
    return at ? length(*at - camera.vector("from").value_or(Vec3d())) : INFINITY;
}

double exposureOf(const StatedThing& camera, Export& to) {
    if (camera.word("exposure") == "auto")
        to.leftOut(camera.span, "`exposure auto`", "state the stops that `abbe render` prints for it");
    if (camera.has("iso")) to.leftOut(camera.span, "`iso`", "state `exposure` in stops instead");
    return std::exp2(camera.number("exposure", 0));
}

Vec2d filmSizeOf(const StatedScene& scene) {
    return scene.film() ? scene.film()->pair("size").value_or(Vec2d(1280, 720)) : Vec2d(1280, 720);
}

bool hiddenFromCamera(const Placed& placed) {
    return !placed.visibleTo.empty() && std::ranges::find(placed.visibleTo, "camera") == placed.visibleTo.end();
}

} // namespace abbe::exchange

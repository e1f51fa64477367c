// Objects as prototypes: native instances of them, and point instancers for many places of one.
#include "exchange/usd_export/usd_writer.h"

#include <array>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr int kDeepestObject = 32; // objects in objects
constexpr double kNothing = 1e-9;  // of turns and sizes: below what singles show

// Where an instance stands: what a point instancer has of it.
struct InstancerPlace {
    Vec3d position;
    Quaternion turn;
    Vec3d sizes{1, 1, 1};
};

// A map that sizes along the axes, then turns, then moves; mirrors are a size below 0.
InstancerPlace instancerPlaceOf(const Transform& map) {
    InstancerPlace place{map.t, {}, {}};
    Transform turn;
    std::array<double, 3> sizes{};
    for (int c = 0; c < 3; ++c) {
        const Vec3d axis(map.a[0][c], map.a[1][c], map.a[2][c]);
        sizes[static_cast<std::size_t>(c)] = length(axis);
        for (int r = 0; r < 3; ++r) turn.a[r][c] = axis[r] / length(axis);
    }
    const auto axisOf = [&](int c) { return Vec3d(turn.a[0][c], turn.a[1][c], turn.a[2][c]); };
    if (dot(cross(axisOf(0), axisOf(1)), axisOf(2)) < 0) {
        sizes[0] = -sizes[0];
        for (auto& row : turn.a) row[0] = -row[0];
    }
    place.sizes = {sizes[0], sizes[1], sizes[2]};
    place.turn = Decomposition::of(turn).rotation;
    return place;
}

std::string usdQuaternion(const Quaternion& q) {
    return fmt::format("({}, {}, {}, {})", usdFloat(q.w), usdFloat(q.v.x), usdFloat(q.v.y), usdFloat(q.v.z));
}

// The path of an object's prim, below one that is not rendered by itself.
std::string prototypeOf(const std::string& object, UsdWriter& w) {
    const auto [at, fresh] = w.prototypes.emplace(object, std::string());
    if (!fresh) return at->second;
    UsdPrim prim("Xform", w.take(object, "object"));
    at->second = "/Objects/" + prim.name();
    const std::string path = at->second;
    for (const Placed& part : w.out.scene.object(object)) usdWritePlaced(part, prim, w);
    w.objects.add(std::move(prim));
    return path;
}

// Whether a light is in an object. Programs draw lights in native instances, but not in those of a point instancer.
bool objectShines(const std::string& object, const StatedScene& scene, int depth = 0) {
    if (depth > kDeepestObject) return false;
    for (const Placed& part : scene.object(object)) {
        const StatedThing* const thing = part.thing;
        if (!thing || thing->kind == schema::Kind::instances) {
            if (objectShines(thing ? thing->target : part.object, scene, depth + 1)) return true;
        } else if (thing->kind == schema::Kind::light || thing->spectrum("emission")) {
            return true;
        }
    }
    return false;
}

void writePlaces(UsdPrim& prim, const std::vector<Transform>& maps) {
    std::vector<InstancerPlace> places;
    places.reserve(maps.size());
    bool turned = false, sized = false;
    for (const Transform& map : maps) {
        const InstancerPlace& one = places.emplace_back(instancerPlaceOf(map));
        turned = turned || length(one.turn.v) > kNothing;
        sized = sized || length(one.sizes - Vec3d(1, 1, 1)) > kNothing;
    }
    prim.set("int[] protoIndices", usdArray(maps, [](const Transform&) { return std::string("0"); }));
    prim.set("point3f[] positions", usdArray(places, [](const auto& p) { return usdFloats(p.position); }));
    if (turned) {
        // Halves are 3e-4 rad off. Where both are stated, whoever knows the singles takes those [OpenUSD 24.08].
        const std::string turns = usdArray(places, [](const auto& p) { return usdQuaternion(p.turn); });
        prim.set("quath[] orientations", turns).set("quatf[] orientationsf", turns);
    }
    if (sized) prim.set("float3[] scales", usdArray(places, [](const auto& p) { return usdFloats(p.sizes); }));
}

} // namespace

std::string usdPathIn(const UsdPrim& parent, const UsdPrim& child) {
    const std::string above = parent.name() == "World" ? "/World/" : fmt::format("/Objects/{}/", parent.name());
    return above + child.name();
}

void usdWriteInstance(const Placed& placed, UsdPrim& parent, UsdWriter& w) {
    const std::string path = prototypeOf(placed.object, w);
    UsdPrim prim("Xform", w.take(placed.object, "instance"));
    prim.metadata("instanceable = true").metadata(fmt::format("prepend references = <{}>", path));
    usdPlace(prim, placed, {}, w);
    parent.add(std::move(w.withRemarks(prim)));
}

void usdWriteInstances(const Placed& placed, UsdPrim& parent, UsdWriter& w) {
    const StatedThing& thing = *placed.thing;
    Export::ignore(thing, {"points", "scatter", "over", "area", "seed", "turn", "scale", "align", "grid", "spacing"});
    const std::vector<Transform>* const places = w.out.scene.places(placed);
    if (!places) return w.out.leftOut(thing.span, "`instances`", "where they stand is not known");
    if (places->empty()) return; // shows nothing here either
    if (objectShines(thing.target, w.out.scene)) {
        for (const Transform& place : *places) {
            Placed one = placed;
            one.thing = nullptr;
            one.object = thing.target;
            one.toWorld = place.then(placed.toWorld);
            one.motion = Motion(place).then(placed.motion);
            usdWriteInstance(one, parent, w);
        }
        return;
    }
    const std::string prototype = prototypeOf(thing.target, w);
    UsdPrim prim("PointInstancer", w.take(thing.name.empty() ? thing.target : thing.name, "instances"));
    // Prototypes below their instancer are drawn by it alone, in all programs.
    UsdPrim shown("Xform", "prototype"), scope("Scope", "Prototypes");
    shown.metadata(fmt::format("prepend references = <{}>", prototype));
    prim.set("rel prototypes", fmt::format("<{}/Prototypes/prototype>", usdPathIn(parent, prim)));
    writePlaces(prim, *places);
    usdPlace(prim, placed, {}, w);
    prim.add(std::move(scope.add(std::move(shown))));
    parent.add(std::move(w.withRemarks(prim)));
}

} // namespace abbe::exchange

// Cameras, the film and what a render is asked for.
#include "exchange/usd_export/usd_writer.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr double kTenth = 10; // focal lengths and apertures are in tenths of a unit, which is a metre

// Of a camera with blocks `at`: its place at each of their times.
Motion motionOf(const StatedThing& camera, const StatedScene& scene, std::vector<double>& moments) {
    const auto* const times =
        camera.find(camera.has("transform") ? StatedThing::kTransformTimes : StatedThing::kMoments);
    for (const auto& time : times ? *times : std::vector<schema::BoundValue>())
        moments.push_back(std::get<double>(time));
    if (const auto* keyed = camera.value<KeyedTransform>("transform")) return Motion().then(*keyed);
    if (!times) return Motion(cameraToWorld(camera, scene));
    const auto stated = [&](std::string_view name, std::size_t i, Vec3d otherwise) {
        const auto* const all = camera.find("at." + std::string(name));
        if (!all) return camera.vector(name).value_or(otherwise);
        return all->size() == times->size() ? std::get<Vec3d>((*all)[i]) : otherwise;
    };
    std::vector<KeyedTransform::Key> keys;
    for (std::size_t i = 0; i < times->size(); ++i) {
        const Vec3d from = stated("from", i, {});
        const Vec3d to = stated("look-at", i, from + (scene.zUp() ? Vec3d(0, 1, 0) : Vec3d(0, 0, -1)));
        const auto map = Transform::lookAt(from, to, stated("up", i, scene.up()));
        TransformStep step;
        step.kind = TransformStep::Kind::matrix;
        step.matrix = map.value_or(Transform::translate(from));
        keys.push_back({std::get<double>((*times)[i]), {step}});
    }
    return Motion().then(KeyedTransform(std::move(keys)));
}

bool keysAreWhole(const StatedThing& camera) {
    const auto* const times = camera.find(StatedThing::kMoments);
    return std::ranges::all_of(std::initializer_list<std::string_view>{"at.from", "at.look-at", "at.up"},
                               [&](auto name) {
                                   const auto* const all = camera.find(name);
                                   return !times || !all || all->size() == times->size();
                               });
}

// Without scale: what stretches cameras in a scene stretches no picture.
Transform rigid(Transform map) {
    for (int c = 0; c < 3; ++c) {
        const double size = length(Vec3d(map.a[0][c], map.a[1][c], map.a[2][c]));
        for (auto& row : map.a) row[c] /= size;
    }
    return map;
}

void writeLens(const StatedThing& camera, UsdPrim& prim, UsdWriter& w) {
    const Vec2d size = filmSizeOf(w.out.scene);
    const double half = halfWidthOf(camera, size), aspect = size.y / size.x;
    if (camera.type == "orthographic") {
        prim.set("token projection", "\"orthographic\"");
        prim.set("float horizontalAperture", usdFloat(2 * half * kTenth));
        prim.set("float verticalAperture", usdFloat(2 * half * aspect * kTenth));
        return;
    }
    const double wide = camera.pair("sensor").value_or(Vec2d(0.036, 0.024)).x * camera.number("squeeze", 1);
    const double focal = wide / (2 * half);
    prim.set("float focalLength", usdFloat(focal * kTenth));
    prim.set("float horizontalAperture", usdFloat(wide * kTenth));
    prim.set("float verticalAperture", usdFloat(wide * aspect * kTenth));
    if (const auto shift = camera.pair("shift")) {
        prim.set("float horizontalApertureOffset", usdFloat(shift->x * kTenth));
        prim.set("float verticalApertureOffset", usdFloat(shift->y * kTenth));
    }
    if (const double radius = lensRadiusOf(camera); radius > 0) {
        const double focus = focusOf(camera, w.out);
        prim.set("float fStop", usdFloat(focal / (2 * radius)));
        prim.set("float focusDistance", usdFloat(std::min(focus, 1e6)));
        if (camera.number("squeeze", 1) != 1)
            w.out.approximated(camera.span, "`squeeze`", "the blur of lenses is round in USD");
    }
}

} // namespace

std::string usdWriteCamera(const StatedThing& camera, UsdPrim& parent, UsdWriter& w) {
    if (camera.type != "perspective" && camera.type != "orthographic") {
        w.out.leftOut(camera.span, fmt::format("camera `{}`", camera.type), "USD has none like it");
        for (const auto& unused : camera.takeUnused()) camera.has(unused.property);
        return {};
    }
    UsdPrim prim("Camera", w.take(camera.name, "camera"));
    writeLens(camera, prim, w);
    if (!keysAreWhole(camera))
        w.out.approximated(camera.span, "a camera whose moments state different things",
                           "state `from`, `look-at` and `up` in each");
    std::vector<double> moments;
    const Motion motion = motionOf(camera, w.out.scene, moments);
    if (motion.moves()) {
        std::vector<std::pair<double, std::string>> values;
        for (const double time : usdTimes(motion, moments, w))
            values.emplace_back(w.code(time), usdMatrix(rigid(motion.at(time))));
        prim.samples("matrix4d xformOp:transform", values);
        prim.set("uniform token[] xformOpOrder", "[\"xformOp:transform\"]");
    } else {
        usdPlace(prim, cameraToWorld(camera, w.out.scene));
    }
    if (const double shutter = camera.number("shutter", 0); shutter > 0) {
        prim.set("double shutter:open", "0");
        prim.set("double shutter:close", usdNumber(w.code(shutter)));
    }
    // A nit shows as 1 without an exposure, as in other renderers of UsdLux.
    prim.set("float exposure", usdFloat(std::log2(exposureOf(camera, w.out) / kUnitLuminance)));
    Export::ignore(camera, {"fov", "lens", "f-stop", "aperture", "focus", "from", "look-at", "up", "at", "transform",
                            "time", "width", "height", "sensor", "squeeze"});
    w.out.leaveOutUnused(camera);
    w.withRemarks(prim);
    std::string path = "/World/" + prim.name();
    parent.add(std::move(prim));
    return path;
}

UsdPrim usdSettings(const std::string& camera, UsdWriter& w) {
    const StatedThing* const film = w.out.scene.film();
    const Vec2d size = filmSizeOf(w.out.scene);
    UsdPrim prim("RenderSettings", "settings");
    prim.set("uniform int2 resolution", fmt::format("({}, {})", size.x, size.y));
    if (!camera.empty()) prim.set("rel camera", fmt::format("<{}>", camera));
    if (const auto* crop = film ? film->value<std::vector<double>>("crop") : nullptr; crop && crop->size() == 4) {
        const auto& c = *crop; // left, top, right, bottom in pixels from above; there from below
        prim.set("uniform float4 dataWindowNDC",
                 fmt::format("({}, {}, {}, {})", usdFloat(c[0] / size.x), usdFloat(1 - c[3] / size.y),
                             usdFloat(c[2] / size.x), usdFloat(1 - c[1] / size.y)));
    }
    if (film) {
        if (const std::string output = film->word("output"); !output.empty()) {
            UsdPrim product("RenderProduct", "product");
            product.set("token productName", usdText(output));
            prim.set("rel products", "</Render/settings/product>");
            prim.add(std::move(product));
        }
        w.out.leaveOutUnused(*film);
    }
    w.withRemarks(prim);
    return prim;
}

} // namespace abbe::exchange

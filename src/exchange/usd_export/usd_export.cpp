#include "exchange/usd_export/usd_writer.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr double kStep = 2 * kDegree; // of turning between two samples, which are interpolated entry by entry
constexpr int kMostSteps = 256;       // between two keys

// How far a map turns, at most, in rad.
double turnBetween(const Transform& a, const Transform& b) {
    const auto from = Decomposition::of(a).rotation, to = Decomposition::of(b).rotation;
    const double c = std::abs(from.w * to.w + dot(from.v, to.v));
    return 2 * std::acos(std::min(1.0, c));
}

std::string headerText(const UsdWriter& w) {
    const StatedScene& scene = w.out.scene;
    const double start = scene.cameras().empty() ? 0 : scene.cameras()[0]->number("time", 0);
    std::string text = "#usda 1.0\n(\n    defaultPrim = \"World\"\n    metersPerUnit = 1\n";
    text += fmt::format("    upAxis = \"{}\"\n", scene.zUp() ? "Z" : "Y");
    if (start != 0 || w.last > 0) {
        text += fmt::format("    startTimeCode = {}\n", usdNumber(w.code(start)));
        text += fmt::format("    endTimeCode = {}\n", usdNumber(w.code(std::max(start, w.last))));
    }
    if (start != 0 || w.last > 0 || w.perSecond != 24)
        text += fmt::format("    timeCodesPerSecond = {0}\n    framesPerSecond = {0}\n", usdNumber(w.perSecond));
    return text + "    renderSettingsPrimPath = \"/Render/settings\"\n)\n\n";
}

} // namespace

void usdWritePlaced(const Placed& placed, UsdPrim& parent, UsdWriter& w) {
    if (!placed.visibleTo.empty()) w.out.leftOut(placed.span, "`visible-to`", "every ray sees everything in USD");
    if (!placed.thing) return usdWriteInstance(placed, parent, w);
    const StatedThing& thing = *placed.thing;
    if (thing.kind == schema::Kind::light) {
        usdWriteLight(placed, parent, w);
    } else if (thing.kind == schema::Kind::volume) {
        usdWriteVolume(placed, parent, w);
    } else if (thing.kind == schema::Kind::instances) {
        usdWriteInstances(placed, parent, w);
    } else {
        usdWriteShape(placed, parent, w);
    }
    w.out.leaveOutUnused(thing);
}

std::string UsdWriter::take(std::string_view wish, std::string_view fallback) {
    std::string name;
    for (const char c : wish.empty() ? fallback : wish) {
        const bool digit = c >= '0' && c <= '9', letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (name.empty() && digit) name += '_';
        name += letter || digit ? c : '_';
    }
    std::string free = name;
    for (int i = 2; !names.insert(free).second; ++i) free = fmt::format("{}_{}", name, i);
    return free;
}

std::vector<double> usdTimes(const Motion& motion, const std::vector<double>& keys, UsdWriter& w) {
    std::vector<double> times;
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
        times.push_back(keys[i]);
        // A turn may come back to where it began, so it is looked at on its way.
        constexpr int kLooks = 16;
        double turn = 0;
        const auto look = [&](int k) { return motion.at(keys[i] + (keys[i + 1] - keys[i]) * k / kLooks); };
        for (int k = 0; k < kLooks; ++k) turn += turnBetween(look(k), look(k + 1));
        const int pieces = std::clamp(static_cast<int>(std::ceil(turn / kStep)), 1, kMostSteps);
        for (int k = 1; k < pieces; ++k) times.push_back(keys[i] + (keys[i + 1] - keys[i]) * k / pieces);
    }
    if (!keys.empty()) {
        times.push_back(keys.back());
        w.last = std::max(w.last, keys.back());
    }
    return times;
}

void usdPlace(UsdPrim& prim, const Transform& map) {
    if (map == Transform()) return;
    prim.set("matrix4d xformOp:transform", usdMatrix(map));
    prim.set("uniform token[] xformOpOrder", "[\"xformOp:transform\"]");
}

void usdPlace(UsdPrim& prim, const Placed& placed, const Transform& before, UsdWriter& w) {
    if (!placed.moves) return usdPlace(prim, before.then(placed.toWorld));
    std::vector<std::pair<double, std::string>> values;
    for (const double time : usdTimes(placed.motion, placed.times, w))
        values.emplace_back(w.code(time), usdMatrix(before.then(placed.motion.at(time))));
    prim.samples("matrix4d xformOp:transform", values);
    prim.set("uniform token[] xformOpOrder", "[\"xformOp:transform\"]");
}

std::string exportUsd(Export& to) {
    UsdWriter w(to);
    if (const StatedThing* render = to.scene.render()) w.perSecond = render->number("fps", 24);
    std::string camera;
    for (const StatedThing* one : to.scene.cameras()) {
        const std::string path = usdWriteCamera(*one, w.world, w);
        if (camera.empty()) camera = path;
    }
    for (const Placed& placed : to.scene.placed()) usdWritePlaced(placed, w.world, w);
    if (to.scene.atmosphere()) to.leftOut(to.scene.atmosphere()->span, "`atmosphere`", "media of USD are volumes");
    w.withRemarks(w.world);
    const UsdPrim settings = usdSettings(camera, w);
    std::string text = headerText(w);
    w.world.write(text, 0);
    if (!w.looks.empty()) w.looks.write(text, 0);
    if (!w.objects.empty()) w.objects.specifier("class").write(text, 0);
    UsdPrim render("Scope", "Render");
    render.add(settings).write(text, 0);
    return text;
}

} // namespace abbe::exchange

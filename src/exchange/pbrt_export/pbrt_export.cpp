#include "exchange/pbrt_export/pbrt_writer.h"
#include "exchange/shared/scene_node.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

double nineDigits(double v) { return std::strtod(pbrtNumber(v).c_str(), nullptr); }

// What `LookAt` takes, in pbrt's world, such that it comes out the same when it is read and written again.
struct PbrtEye {
    Vec3d from, at, up;
};
PbrtEye eyeOf(const Transform& cameraToWorld, double ahead) {
    PbrtEye eye;
    eye.from = onGrid(pbrtMirrored(cameraToWorld.t));
    eye.at = onGrid(eye.from + pbrtMirrored(cameraToWorld.vector({0, 0, -1})) * ahead);
    eye.up = onGrid(pbrtMirrored(cameraToWorld.vector({0, 1, 0})));
    for (int i = 0; i < 16; ++i) {
        const PbrtEye last = eye;
        const Vec3d forward = normalize(eye.at - eye.from), right = normalize(cross(eye.up, forward));
        eye.at = onGrid(eye.from + forward * ahead);
        eye.up = onGrid(cross(forward, right));
        if (eye.at == last.at && eye.up == last.up) break;
    }
    return eye;
}

std::string lookAtLine(const PbrtEye& eye) {
    const auto text = [](Vec3d v) {
        return fmt::format("{} {} {}", numberText(v.x), numberText(v.y), numberText(v.z));
    };
    return fmt::format("LookAt {}  {}  {}\n", text(eye.from), text(eye.at), text(eye.up));
}

std::string filterLine(const StatedThing* film, PbrtWriter& w) {
    const std::string type = film ? film->word("filter") : "blackman-harris";
    const double given = film && film->number("filter") ? *film->number("filter") : 0;
    PbrtList list;
    std::string theirs = type;
    double radius = given;
    if (type == "box")
        radius = given == 0 ? 0.5 : given;
    else if (type == "triangle")
        radius = given == 0 ? 1 : given;
    else if (type == "mitchell")
        radius = given == 0 ? 2 : given;
    else {
        radius = given == 0 ? 1.5 : given;
        theirs = "gaussian";
        if (type != "gaussian")
            w.out.approximated(film ? film->span : w.out.scene.span(), fmt::format("filter `{}`", type),
                               "by a Gaussian as wide");
    }
    list.number("xradius", radius).number("yradius", radius);
    if (theirs == "gaussian") list.number("sigma", radius / 3);
    return fmt::format("PixelFilter \"{}\"{}\n", theirs, list.str());
}

std::string filmLine(double exposure, PbrtWriter& w) {
    const StatedThing* const film = w.out.scene.film();
    const Vec2d size = filmSizeOf(w.out.scene);
    PbrtList list;
    list.integer("xresolution", size.x).integer("yresolution", size.y);
    if (const auto* crop = film ? film->value<std::vector<double>>("crop") : nullptr; crop && crop->size() == 4)
        list.add("integer", "pixelbounds", fmt::format("{} {} {} {}", (*crop)[0], (*crop)[2], (*crop)[1], (*crop)[3]));
    std::string output = film ? film->word("output") : std::string();
    if (output.empty()) output = "picture.exr";
    list.text("string", "filename", output);
    const std::string sensor = film ? film->word("sensor") : std::string();
    constexpr std::pair<std::string_view, std::string_view> kSensors[] = {
        {"canon-5d-mark-iv", "canon_eos_5d_mkiv"}, {"nikon-d850", "nikon_d850"}, {"sony-a7-iv", "sony_ilce_7m4"}};
    std::string_view theirs = "cie1931";
    for (const auto& [ours, name] : kSensors)
        if (sensor == ours) theirs = name;
    list.text("string", "sensor", theirs);
    if (pbrtNumber(exposure) != "1") list.number("iso", 100 * exposure);
    if (film) w.out.leaveOutUnused(*film);
    return fmt::format("Film \"rgb\"{}\n", list.str());
}

void addLens(PbrtList& list, const StatedThing& camera, PbrtWriter& w) {
    const Vec2d size = filmSizeOf(w.out.scene);
    const double half = halfWidthOf(camera, size), aspect = size.x / size.y;
    // The angle across the shorter side.
    const double shorter = aspect > 1 ? half / aspect : half;
    list.number("fov", 2 * std::atan(shorter) / kDegree);
    const Vec2d shift = camera.pair("shift").value_or(Vec2d());
    if (shift.x != 0 || shift.y != 0) {
        // A window on the plane where the shorter side is from −1 to 1.
        const double sensor = camera.pair("sensor").value_or(Vec2d(0.036, 0.024)).x, unit = 2 * half / sensor / shorter;
        const double across = std::max(aspect, 1.0), down = std::max(1 / aspect, 1.0);
        const double x = shift.x * unit, y = shift.y * unit;
        list.add("float", "screenwindow",
                 fmt::format("{} {} {} {}", pbrtNumber(x - across), pbrtNumber(x + across), pbrtNumber(y - down),
                             pbrtNumber(y + down)));
    }
    if (const double radius = lensRadiusOf(camera); radius > 0)
        list.number("lensradius", radius).number("focaldistance", std::min(1e6, focusOf(camera, w.out)));
}

// Distance of the point that is looked at, which importers keep with a lens.
double aheadOf(const StatedThing& camera, Export& to) {
    if (camera.type != "perspective" || lensRadiusOf(camera) == 0) return 1;
    const double focus = focusOf(camera, to);
    return focus < 1e5 ? nineDigits(focus) : 1;
}

std::string cameraText(const StatedThing& camera, PbrtWriter& w) {
    const StatedScene& scene = w.out.scene;
    const Vec2d size = filmSizeOf(scene);
    const Transform map = cameraToWorld(camera, scene);
    std::string text = lookAtLine(eyeOf(map, aheadOf(camera, w.out)));
    PbrtList list;
    if (camera.type == "perspective") {
        addLens(list, camera, w);
    } else if (camera.type == "orthographic") {
        const double half = halfWidthOf(camera, size), tall = half * size.y / size.x;
        list.add("float", "screenwindow",
                 fmt::format("{} {} {} {}", pbrtNumber(-half), pbrtNumber(half), pbrtNumber(-tall), pbrtNumber(tall)));
    } else {
        w.out.leftOut(camera.span, fmt::format("camera `{}`", camera.type), "it is not written for pbrt");
        return w.remarks();
    }
    Export::ignore(camera, {"exposure", "iso", "focus", "f-stop", "aperture", "sensor", "lens", "fov", "look-at",
                            "from", "up", "at", "time", "shutter", "shutter.opening", "shutter.closing", "transform"});
    w.out.leaveOutUnused(camera);
    return w.remarks() + text + fmt::format("Camera \"{}\"{}\n", camera.type, list.str());
}

} // namespace

void pbrtWriteView(PbrtWriter& w) {
    const StatedScene& scene = w.out.scene;
    const StatedThing* const camera = scene.cameras().empty() ? nullptr : scene.cameras()[0];
    for (std::size_t i = 1; i < scene.cameras().size(); ++i)
        w.out.leftOut(scene.cameras()[i]->span, fmt::format("camera `{}`", scene.cameras()[i]->name), "pbrt has one");
    if (!w.outside.empty()) w.settings += fmt::format("MediumInterface \"\" \"{}\"\n", w.outside);
    if (camera) w.settings += cameraText(*camera, w);
    const double exposure = camera ? exposureOf(*camera, w.out) : 1;
    const std::string filter = filterLine(scene.film(), w), film = filmLine(exposure, w);
    w.settings += w.remarks() + film + filter;
    const StatedThing* const render = scene.render();
    PbrtList sampler, integrator;
    sampler.integer("pixelsamples", render ? render->number("samples", 64) : 64);
    const double depth = render ? render->number("max-depth", 0) : 0, seed = render ? render->number("seed", 0) : 0;
    constexpr double kEndless = 100000; // paths end by Russian roulette
    integrator.integer("maxdepth", depth == 0 ? kEndless : depth);
    if (seed != 0) w.settings += fmt::format("Option \"integer seed\" [ {} ]\n", pbrtNumber(seed));
    w.settings += fmt::format("Sampler \"zsobol\"{}\nIntegrator \"volpath\"{}\n", sampler.str(), integrator.str());
}

std::string exportPbrt(Export& to) {
    PbrtWriter w(to);
    if (const StatedThing* medium = to.scene.atmosphere()) {
        w.outside = pbrtMediumName(*medium, w);
        w.settings = std::exchange(w.definitions, {}); // in front of the camera
        if (!w.outside.empty()) w.world += fmt::format("MediumInterface \"\" \"{}\"\n", w.outside);
    }
    pbrtWriteView(w);
    for (const Placed& placed : to.scene.placed()) pbrtWritePlaced(placed, w);
    return fmt::format("# Written for pbrt-v4.\n{}\nWorldBegin\n\n{}\n{}", w.settings, w.definitions, w.world);
}

} // namespace abbe::exchange

#include "exchange/mitsuba_export/mitsuba_writer.h"
#include "exchange/shared/scene_node.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <sstream>

namespace abbe::exchange {

namespace {

void writePixelFilter(pugi::xml_node film, const StatedThing* stated, MitsubaWriter& w) {
    const std::string type = stated ? stated->word("filter") : "blackman-harris";
    const double radius = stated && stated->number("filter") ? *stated->number("filter") : 0;
    if (type == "box" && (radius == 0 || radius == 0.5)) {
        xmlChild(film, "rfilter", "box");
    } else if (type == "triangle") {
        xmlNumber(xmlChild(film, "rfilter", "tent"), "radius", radius == 0 ? 1 : radius);
    } else if (type == "mitchell" && (radius == 0 || radius == 2)) {
        xmlChild(film, "rfilter", "mitchell");
    } else {
        const double reach = radius == 0 ? 1.5 : radius;
        xmlNumber(xmlChild(film, "rfilter", "gaussian"), "stddev", rounded(reach / 3));
        if (type != "gaussian")
            w.out.approximated(stated ? stated->span : w.out.scene.span(), fmt::format("filter `{}`", type),
                               "by a Gaussian as wide");
    }
}

void writeFilmNode(pugi::xml_node sensor, MitsubaWriter& w) {
    const StatedThing* const stated = w.out.scene.film();
    pugi::xml_node film = xmlChild(sensor, "film", "hdrfilm");
    const Vec2d size = filmSizeOf(w.out.scene);
    const auto whole = [&](const char* name, double v) { xmlValue(film, "integer", name, numberText(v)); };
    whole("width", size.x);
    whole("height", size.y);
    if (const auto* crop = stated ? stated->value<std::vector<double>>("crop") : nullptr; crop && crop->size() == 4) {
        whole("crop_offset_x", (*crop)[0]);
        whole("crop_offset_y", (*crop)[1]);
        whole("crop_width", (*crop)[2] - (*crop)[0]);
        whole("crop_height", (*crop)[3] - (*crop)[1]);
    }
    xmlValue(film, "string", "pixel_format", "rgb");
    writePixelFilter(film, stated, w);
    if (stated) Export::ignore(*stated, {"output"});
    w.remark(film);
}

// Their shift is a fraction of what is rendered.
void writeShift(pugi::xml_node sensor, const StatedThing& camera, MitsubaWriter& w) {
    const Vec2d shift = camera.pair("shift").value_or(Vec2d());
    if (shift.x == 0 && shift.y == 0) return;
    const Vec2d size = filmSizeOf(w.out.scene);
    Vec2d part = size;
    const StatedThing* const film = w.out.scene.film();
    if (const auto* crop = film ? film->value<std::vector<double>>("crop") : nullptr; crop && crop->size() == 4)
        part = {(*crop)[2] - (*crop)[0], (*crop)[3] - (*crop)[1]};
    const double sensorWidth = camera.pair("sensor").value_or(Vec2d(0.036, 0.024)).x;
    xmlNumber(sensor, "principal_point_offset_x", rounded(shift.x / sensorWidth * size.x / part.x));
    xmlNumber(sensor, "principal_point_offset_y", rounded(-shift.y / sensorWidth * size.x / part.y));
}

void writeSettings(MitsubaWriter& w) {
    const StatedThing* const render = w.out.scene.render();
    const double depth = render ? render->number("max-depth", 0) : 0;
    pugi::xml_node node = xmlChild(w.root, "integrator", w.hasMedia ? "volpath" : "path");
    xmlValue(node, "integer", "max_depth", numberText(depth == 0 ? -1 : depth + 1));
    if (w.hidesLights) xmlFlag(node, "hide_emitters", true);
    w.root.prepend_move(node);
}

bool isLightOf(const Placed& p) {
    return p.thing && (p.thing->kind == schema::Kind::light || p.thing->spectrum("emission"));
}

void writeScene(MitsubaWriter& w) {
    const StatedScene& scene = w.out.scene;
    const auto& placed = scene.placed();
    w.hidesLights = std::ranges::any_of(placed, isLightOf) &&
                    std::ranges::all_of(placed, [](const Placed& p) { return !isLightOf(p) || hiddenFromCamera(p); });
    if (scene.cameras().empty())
        w.out.leftOut(scene.span(), "the camera", "there is none");
    else
        w.exposure = exposureOf(*scene.cameras()[0], w.out);
    if (w.exposure != 1)
        w.out.approximated(scene.cameras()[0]->span, "`exposure`", "all lights are brighter by as much");
    for (const StatedThing* camera : scene.cameras()) writeMitsubaCamera(*camera, w);
    for (const Placed& one : placed) {
        writeMitsubaShape(w.body, one, w);
        if (const pugi::xml_node last = w.body.last_child()) w.remark(last);
    }
    if (scene.atmosphere())
        w.out.leftOut(scene.atmosphere()->span, "`atmosphere`", "Mitsuba's media are inside of shapes");
    if (scene.film()) w.out.leaveOutUnused(*scene.film());
    writeSettings(w);
    for (pugi::xml_node node = w.body.first_child(); node; node = node.next_sibling()) w.root.append_copy(node);
}

} // namespace

void writeMitsubaCamera(const StatedThing& camera, MitsubaWriter& w) {
    const Vec2d size = filmSizeOf(w.out.scene);
    const bool orthographic = camera.type == "orthographic";
    if (camera.type != "perspective" && !orthographic) {
        w.out.leftOut(camera.span, fmt::format("camera `{}`", camera.type), "Mitsuba has none like it");
        return;
    }
    const double half = halfWidthOf(camera, size), radius = orthographic ? 0 : lensRadiusOf(camera);
    pugi::xml_node node = xmlChild(w.root, "sensor",
                                   orthographic ? "orthographic"
                                   : radius > 0 ? "thinlens"
                                                : "perspective",
                                   {}, w.takeId(camera.name, "camera"));
    // Theirs look along +z with +x to the left.
    Transform map = Transform::scale({-1, 1, -1}).then(cameraToWorld(camera, w.out.scene));
    if (orthographic) map = Transform::scale({half, half, 1}).then(map);
    if (!orthographic) {
        xmlValue(node, "string", "fov_axis", "x");
        xmlNumber(node, "fov", rounded(2 * std::atan(half) / kDegree));
        writeShift(node, camera, w);
    }
    if (radius > 0) {
        constexpr double kFarthest = 1e8; // as good as infinite
        xmlNumber(node, "aperture_radius", rounded(radius));
        xmlNumber(node, "focus_distance", rounded(std::min(kFarthest, focusOf(camera, w.out))));
    }
    xmlTransform(node, map);
    writeFilmNode(node, w);
    const StatedThing* const render = w.out.scene.render();
    xmlValue(xmlChild(node, "sampler", "independent"), "integer", "sample_count",
             numberText(render ? render->number("samples", 64) : 64));
    Export::ignore(camera, {"focus", "f-stop", "aperture", "sensor", "lens", "fov", "look-at", "from", "up", "at",
                            "time", "shutter", "shutter.opening", "shutter.closing", "transform"});
    w.out.leaveOutUnused(camera);
    w.remark(node);
}

std::string exportMitsuba(Export& to) {
    pugi::xml_document document, seen;
    MitsubaWriter w(to);
    w.root = document.append_child("scene");
    w.root.append_attribute("version") = "3.0.0";
    w.body = seen.append_child("scene");
    writeScene(w);
    std::ostringstream text;
    document.save(text, "    ", pugi::format_indent | pugi::format_no_declaration, pugi::encoding_utf8);
    return text.str();
}

} // namespace abbe::exchange

#include "exchange/mitsuba_export/mitsuba_writer.h"
#include "exchange/shared/scene_node.h"
#include "exchange/stated/stated_mesh.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

void xmlTriple(pugi::xml_node parent, const char* tag, const char* name, Vec3d v) {
    xmlValue(parent, tag, name, fmt::format("{} {} {}", numberText(v.x), numberText(v.y), numberText(v.z)));
}

struct LightSiteThere {
    pugi::xml_node parent;
    const Placed& placed;
    const StatedThing& light;
    MitsubaWriter& w;

    pugi::xml_node node(std::string_view type) const {
        return xmlChild(parent, "emitter", type, {}, w.takeId(light.name, std::string(type) + "-light"));
    }
    void spectrum(pugi::xml_node node, const char* name, const StatedLight& s) const {
        xmlSpectrum(node, name, plainSpectrum(*s.curve, s.scale * w.exposure));
    }
};

void writePoint(const LightSiteThere& site) {
    const auto stated = statedLight(site.light, {.power = 4 * kPiD}, site.w.out.scene);
    if (!stated) return;
    pugi::xml_node node = site.node("point");
    xmlTriple(node, "point", "position", site.placed.toWorld.point(site.light.vector("position").value_or(Vec3d())));
    site.spectrum(node, "intensity", *stated);
    site.w.remark(node);
}

double oneMinusCos(double x) { return 2 * std::sin(x / 2) * std::sin(x / 2); }

void writeSpot(const LightSiteThere& site) {
    const double angle = site.light.number("angle", 45 * kDegree),
                 inner = site.light.number("inner-angle", 0.8 * angle);
    const double outside = oneMinusCos(angle / 2), inside = oneMinusCos(inner / 2);
    const auto stated = statedLight(site.light, {.power = kPiD * (outside + inside)}, site.w.out.scene);
    if (!stated) return;
    pugi::xml_node node = site.node("spot");
    const auto [at, axis] = axisOfLight(site.placed, site.light);
    xmlTransform(node, mapToAxis(at, axis));
    xmlNumber(node, "cutoff_angle", rounded(angle / 2 / kDegree));
    xmlNumber(node, "beam_width", rounded(inner / 2 / kDegree));
    site.spectrum(node, "intensity", *stated);
    if (inner < angle)
        site.w.out.approximated(site.light.span, "the edge of `spot`",
                                "it falls evenly with the angle, not by a smooth step of the cosine");
    site.w.remark(node);
}

void writeSun(const LightSiteThere& site) {
    const auto stated = statedSun(site.light, site.w.out);
    pugi::xml_node node = site.node("directional");
    xmlTriple(node, "vector", "direction", sunToward(site.placed, site.light, site.w.out.scene));
    site.spectrum(node, "irradiance", stated);
    site.w.remark(node);
}

void writeSky(const LightSiteThere& site) {
    const auto stated = statedLight(site.light, {.irradiance = kPiD}, site.w.out.scene, 20000);
    pugi::xml_node node = site.node("constant");
    site.spectrum(node, "radiance", *stated);
    Export::ignore(site.light, {"portals"}); // they change no picture
    site.w.remark(node);
}

// The middle of Mitsuba's image lies towards +z, ours towards −z.
void writeEnvironment(const LightSiteThere& site) {
    const auto* const file = site.light.value<schema::Text>("image");
    if (!file) return;
    pugi::xml_node node = site.node("envmap");
    xmlValue(node, "string", "filename", site.w.out.files.refer(file->value));
    const double scale = environmentScale(site.light) * site.w.exposure;
    if (scale != 1) xmlNumber(node, "scale", rounded(scale));
    xmlTransform(node, Transform::scale({-1, 1, -1}).then(environmentToWorld(site.placed, site.w.out.scene)));
    Export::ignore(site.light, {"portals"});
    site.w.remark(node);
}

// z is up in the sky's own space.
void writeDaylight(const LightSiteThere& site) {
    const bool sun = site.light.word("sun") != "off";
    const StatedScene& scene = site.w.out.scene;
    pugi::xml_node node = site.node("sunsky");
    const Vec3d up = site.placed.toWorld.vector(scene.up());
    const Transform map =
        scene.zUp() ? site.placed.toWorld : Transform::rotate({1, 0, 0}, -kPiD / 2).then(site.placed.toWorld);
    const Vec3d away = -sunToward(site.placed, site.light, scene);
    const auto back = map.inverse();
    xmlTriple(node, "vector", "sun_direction", back ? back->vector(away) : up);
    xmlNumber(node, "turbidity", site.light.number("turbidity", 3));
    if (const StatedSpectrum albedo = site.light.spectrum("ground-albedo"); albedo.curve)
        xmlSpectrum(node, "albedo", plainSpectrum(*albedo.curve));
    if (!sun) xmlNumber(node, "sun_scale", 0);
    Export::ignore(site.light, {"portals"});
    xmlTransform(node, map);
    site.w.out.approximated(site.light.span, "`daylight`",
                            "by Mitsuba's `sunsky`, whose brightness and colours differ");
    site.w.remark(node);
}

// Light that leaves a disk at right angles.
void writeBeam(const LightSiteThere& site) {
    const double radius = site.light.number("radius", 0.005);
    const auto stated = statedLight(site.light, {.power = kPiD * radius * radius, .irradiance = 1}, site.w.out.scene);
    if (!stated) return;
    const auto [at, axis] = axisOfLight(site.placed, site.light);
    pugi::xml_node node = xmlChild(site.parent, "shape", "disk", {}, site.w.takeId(site.light.name, "beam"));
    xmlTransform(node, Transform::scale({radius, radius, radius}).then(mapToAxis(at, axis)));
    xmlChild(node, "bsdf", "null");
    site.spectrum(xmlChild(node, "emitter", "directionalarea"), "radiance", *stated);
    if (site.light.has("divergence"))
        site.w.out.approximated(site.light.span, "`divergence`", "the beam does not spread");
    site.w.remark(node);
}

struct LightRow {
    std::string_view type;
    void (*write)(const LightSiteThere&);
};

constexpr LightRow kLights[] = {
    {"point", writePoint},
    {"spot", writeSpot},
    {"sun", writeSun},
    {"sky", writeSky},
    {"beam", writeBeam},
    {"daylight", writeDaylight},
    {"environment", writeEnvironment},
};

} // namespace

void writeMitsubaLight(pugi::xml_node parent, const Placed& placed, MitsubaWriter& w) {
    const StatedThing& light = *placed.thing;
    const auto row = std::ranges::find(kLights, std::string_view(light.type), &LightRow::type);
    if (row == std::end(kLights)) {
        w.out.leftOut(light.span, fmt::format("light `{}`", light.type), "Mitsuba has nothing like it");
        return;
    }
    row->write({parent, placed, light, w});
    w.out.leaveOutUnused(light);
}

} // namespace abbe::exchange

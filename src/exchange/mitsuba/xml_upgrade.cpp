#include "exchange/mitsuba/xml_object.h"

#include <charconv>

namespace abbe::exchange {

namespace {

// "intIOR" -> "int_ior", "toWorld" -> "to_world", "sigmaT" -> "sigma_t".
std::string snakeCase(std::string_view name) {
    std::string out;
    for (std::size_t i = 0; i < name.size(); ++i) {
        const bool upper = name[i] >= 'A' && name[i] <= 'Z';
        const bool afterLower = i > 0 && !(name[i - 1] >= 'A' && name[i - 1] <= 'Z') && name[i - 1] != '_';
        if (upper && afterLower) out += '_';
        out += upper ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
    }
    return out;
}

double takeNumber(XmlObject& object, std::string_view name, double otherwise) {
    const XmlParam* const found = object.find(name);
    return found && !found->numbers.empty() ? found->numbers[0] : otherwise;
}

void upgradeTexture(XmlObject& object, XmlScene& scene) {
    if (object.tag != "texture") return;
    if (!object.has("uoffset") && !object.has("voffset") && !object.has("uscale") && !object.has("vscale")) return;
    XmlParam map;
    map.tag = "transform";
    map.name = "to_uv";
    map.span = object.span;
    const double u = takeNumber(object, "uscale", 1), v = takeNumber(object, "vscale", 1);
    Transform place = Transform::scale({u, v, 1});
    place.t = {takeNumber(object, "uoffset", 0), takeNumber(object, "voffset", 0), 0};
    map.transform = scene.keep(place);
    object.params.push_back(map);
}

} // namespace

XmlVersion xmlVersion(std::string_view text, XmlVersion otherwise) {
    XmlVersion version{0, 0};
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, version.major);
    if (error != std::errc()) return otherwise;
    if (rest != end && *rest == '.') std::from_chars(rest + 1, end, version.minor);
    return version;
}

void upgradeXmlObject(XmlObject& object, XmlVersion version, XmlScene& scene) {
    if (version.major >= 2) return;
    for (XmlParam& param : object.params) {
        if (const std::string name = snakeCase(param.name); name != param.name) param.name = scene.keep(name);
        if (object.plugin == "diffuse" && param.name == "diffuse_reflectance") param.name = "reflectance";
    }
    upgradeTexture(object, scene);
    if (object.plugin == "sky" || object.plugin == "sun" || object.plugin == "sunsky") {
        XmlParam& up = object.params.emplace_back();
        up.name = kSkyWithYUp;
        up.span = object.span;
        up.used = true;
    }
}

} // namespace abbe::exchange

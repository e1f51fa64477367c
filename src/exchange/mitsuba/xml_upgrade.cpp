#include "exchange/mitsuba/xml_upgrade.h"

#include <charconv>
#include <cmath>

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

void upgradeTexture(XmlObject& object) {
    if (object.tag != "texture") return;
    if (!object.has("uoffset") && !object.has("voffset") && !object.has("uscale") && !object.has("vscale")) return;
    XmlParam map;
    map.tag = "transform";
    map.name = "to_uv";
    map.span = object.span;
    const double u = takeNumber(object, "uscale", 1), v = takeNumber(object, "vscale", 1);
    map.transform = Transform::scale({u, v, 1});
    map.transform.t = {takeNumber(object, "uoffset", 0), takeNumber(object, "voffset", 0), 0};
    object.params.push_back(std::move(map));
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

void upgradeXmlObject(XmlObject& object, XmlVersion version) {
    if (version.major >= 2) return;
    for (XmlParam& param : object.params) {
        param.name = snakeCase(param.name);
        if (object.plugin == "diffuse" && param.name == "diffuse_reflectance") param.name = "reflectance";
    }
    upgradeTexture(object);
}

std::optional<std::vector<double>> xmlHexColor(std::string_view text) {
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    std::vector<double> rgb;
    for (std::size_t i = 1; i < 7; i += 2) {
        int value = 0;
        const auto [end, error] = std::from_chars(text.data() + i, text.data() + i + 2, value, 16);
        if (error != std::errc() || end != text.data() + i + 2) return std::nullopt;
        const double c = value / 255.0; // IEC 61966-2-1
        rgb.push_back(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return rgb;
}

} // namespace abbe::exchange

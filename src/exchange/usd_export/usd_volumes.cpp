// Volumes of OpenVDB files as UsdVol, with MaterialX's anisotropic_vdf.
#include "exchange/usd_export/usd_writer.h"

#include <filesystem>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Scattering and absorption per metre, as colours.
std::pair<Vec3d, Vec3d> coefficientsOf(const StatedThing& v, UsdWriter& w) {
    const auto rgb = [&](const char* property, double otherwise) {
        const StatedSpectrum stated = v.spectrum(property);
        const double plain = v.number(property, otherwise);
        return stated.curve ? rgbOf(*stated.curve, w.out.scene.daylight()) : Vec3d(plain, plain, plain);
    };
    if (v.has("scattering") || v.has("absorption")) return {rgb("scattering", 0), rgb("absorption", 0)};
    const Vec3d extinction = rgb("extinction", 1), albedo = rgb("albedo", 1);
    const Vec3d scattering = eachTimes(extinction, albedo);
    return {scattering, extinction - scattering};
}

std::string volumeMaterial(const StatedThing& v, UsdWriter& w) {
    const std::string name = w.take(v.name.empty() ? "" : v.name + "_medium", "medium"), path = "/Looks/" + name;
    UsdPrim material("Material", name), volume("Shader", "volume"), vdf("Shader", "vdf");
    const auto [scattering, absorption] = coefficientsOf(v, w);
    vdf.set("uniform token info:id", "\"ND_anisotropic_vdf\"");
    vdf.set("vector3f inputs:absorption", usdFloats(absorption))
        .set("vector3f inputs:scattering", usdFloats(scattering));
    vdf.set("float inputs:anisotropy", usdFloat(usdAnisotropy(v, w))).declare("token outputs:out");
    volume.set("uniform token info:id", "\"ND_volume\"");
    volume.set("token inputs:vdf.connect", fmt::format("<{}/vdf.outputs:out>", path)).declare("token outputs:out");
    material.set("token outputs:mtlx:volume.connect", fmt::format("<{}/volume.outputs:out>", path));
    material.add(std::move(volume)).add(std::move(vdf));
    w.looks.add(std::move(material));
    return path;
}

} // namespace

void usdWriteVolume(const Placed& placed, UsdPrim& parent, UsdWriter& w) {
    const StatedThing& v = *placed.thing;
    const auto* const file = v.type == "vdb" ? v.value<schema::Text>("file") : nullptr;
    if (!file || std::filesystem::path(file->value).extension() != ".vdb") {
        w.out.leftOut(v.span, fmt::format("volume `{}`", v.type), "UsdVol has fields of OpenVDB files");
        for (const auto& unused : v.takeUnused()) v.has(unused.property);
        return;
    }
    UsdPrim prim("Volume", w.take(v.name, "volume"));
    const std::string path = usdPathIn(parent, prim), asset = usdFile(w.out.files.refer(file->value));
    for (const char* role : {"density", "temperature", "flame", "color", "velocity"}) {
        std::string grid = v.word(role);
        if (grid.empty() && std::string_view(role) == "density") grid = "density";
        if (grid.empty()) continue;
        UsdPrim field("OpenVDBAsset", role);
        field.set("asset filePath", asset).set("token fieldName", usdText(grid));
        prim.set(fmt::format("rel field:{}", role), fmt::format("<{}/{}>", path, role));
        prim.add(std::move(field));
    }
    if (v.has("temperature") || v.has("emission"))
        w.out.leftOut(v.span, "what the volume emits", "only scattering and absorption are written");
    Export::ignore(v, {"emission", "emissivity"});
    usdPlace(prim, placed, {}, w);
    usdBind(prim, volumeMaterial(v, w));
    parent.add(std::move(w.withRemarks(prim)));
}

} // namespace abbe::exchange

#include "exchange/pbrt/pbrt_import.h"

#include "exchange/pbrt/pbrt_machine.h"
#include "io/file.h"

#include <fmt/format.h>
#include <initializer_list>

namespace abbe::exchange {

namespace {

// The nodes in the order in which a person would read them; what is in pbrt's world in a group that turns it.
void pbrtAssemble(PbrtShared& shared, std::list<SceneNode>& nodes) {
    nodes.splice(nodes.end(), shared.settings);
    nodes.splice(nodes.end(), shared.definitions);
    nodes.splice(nodes.end(), shared.lights);
    if (shared.world.empty()) return;
    if (!shared.mirrored) {
        nodes.splice(nodes.end(), shared.world);
        return;
    }
    SceneNode group("group");
    group.name("world").remark("pbrt's world is left-handed: its x points the other way.");
    group.child("transform").child("scale").number(-1).number(1).number(1);
    for (SceneNode& node : shared.world) group.adopt(std::move(node));
    nodes.push_back(std::move(group));
}

// The names of types, which names that a scene gives would hide; spectra stand where textures do.
void pbrtReserveTypes(PbrtShared& shared) {
    reserveTypeNames(shared.materialNames, shared.textureNames, shared.mediumNames);
    for (const char* spectrum : {"rgb", "srgb", "table", "blackbody", "illuminant", "line", "measured", "glass",
                                 "metal", "sellmeier", "cauchy"})
        shared.textureNames.take(spectrum, {});
}

} // namespace

bool isPbrtScene(const std::filesystem::path& path, std::string_view) {
    const std::string name = path.filename().string();
    return name.ends_with(".pbrt") || name.ends_with(".pbrt.gz");
}

void importPbrt(const std::filesystem::path& path, Import& out) {
    Diagnostics own; // thrown away where a scene of pbrt-v3 would only cause a list of them
    Import import{out.sources, own, out.files, {}};
    PbrtShared shared{import, path.parent_path()};
    pbrtReserveTypes(shared);
    try {
        PbrtMachine machine(shared);
        machine.run(path);
        machine.finish();
        pbrtAssemble(shared, out.nodes);
        out.diagnostics.addAll(own);
    } catch (const PbrtOldScene& old) {
        auto& d = out.diagnostics.error(
            "E0801", old.span, fmt::format("this scene is written for pbrt-v3: {} is not in pbrt-v4", old.what));
        d.help =
            "convert it with pbrt-v4: `pbrt --upgrade old.pbrt > new.pbrt`, and its environment maps with `imgtool "
            "makeequiarea`";
    } catch (const IoError& fault) {
        out.diagnostics.addAll(own);
        out.diagnostics.error("E0802", {}, fault.what());
    }
}

} // namespace abbe::exchange

// Imports of pbrt scenes that stand in tests as text.
#pragma once

#include "exchange/pbrt/pbrt_import.h"
#include "unit/exchange/import_case.h"

#include <string>

namespace abbe::exchange {

// Its `scene` is without the header.
struct PbrtCase : ImportCase {
    explicit PbrtCase(const std::string& text) { import(text); }
    // For those that write files first.
    PbrtCase() = default;
    void import(const std::string& text) {
        writeAll(folder / "case.pbrt", text);
        SideFiles files(folder / "case.scene");
        Import out{sources, diagnostics, files, {}};
        importPbrt(folder / "case.pbrt", out);
        scene = printScene(out.nodes);
    }

    bool has(std::string_view text) const { return scene.find(text) != std::string::npos; }
};

// A view along z, and what stands behind WorldBegin.
inline std::string pbrtWorld(const std::string& world) {
    return "LookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\" \"float fov\" 10\n"
           "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nWorldBegin\n" +
           world;
}

} // namespace abbe::exchange

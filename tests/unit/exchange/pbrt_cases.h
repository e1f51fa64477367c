// Imports of pbrt scenes that stand in tests as text.
#pragma once

#include "base/diagnostic_format.h"
#include "exchange/pbrt/pbrt_import.h"
#include "unit/io/temporary_folder.h"

#include <string>

namespace abbe::exchange {

// What a scene becomes, with the files that it reads and writes in a folder of its own.
struct PbrtCase {
    TemporaryFolder folder;
    SourceMap sources;
    Diagnostics diagnostics;
    std::string scene; // without its header

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
    std::string report() const { return formatShort(diagnostics, sources); }
    bool says(std::string_view text) const { return report().find(text) != std::string::npos; }
};

// A view along z, and what stands behind WorldBegin.
inline std::string pbrtWorld(const std::string& world) {
    return "LookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\" \"float fov\" 10\n"
           "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nWorldBegin\n" +
           world;
}

} // namespace abbe::exchange

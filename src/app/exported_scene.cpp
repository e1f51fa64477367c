#include "app/exported_scene.h"

#include "io/file.h"
#include "scene/build_context.h"

#include <filesystem>

namespace abbe {

void writeExport(const exchange::ExportFormat& format, LoadedScene& loaded, const std::string& target) {
    CurveLibrary curves;
    const exchange::StatedScene scene(loaded.tree, loaded.types,
                                      [&](const schema::SpectrumValue& value, schema::SpectrumRole role,
                                          Diagnostics& found) { return curves.curve(value, role, found); });
    const std::string bytes = exchange::exportScene(format, scene, target, loaded.diagnostics);
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(target).parent_path(), error);
    flushFileSystem(std::filesystem::path(target).parent_path().string());
    writeAtomically(target, bytes);
}

} // namespace abbe

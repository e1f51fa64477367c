#include "app/exported_scene.h"

#include "io/file.h"
#include "scene/build_context.h"
#include "scene/instance_places.h"

#include <filesystem>
#include <optional>

namespace abbe {

void writeExport(const exchange::ExportFormat& format, LoadedScene& loaded, const std::string& target) {
    CurveLibrary curves;
    std::optional<InstancePlaces> places; // found when they are first asked for
    exchange::FindPlaces find;
    if (format.instancers)
        find = [&](const schema::Definition& d) -> const std::vector<Transform>* {
            if (!places) places = findInstancePlaces(loaded.tree, loaded.types);
            const auto found = places->find(&d);
            return found == places->end() ? nullptr : &found->second;
        };
    const exchange::StatedScene scene(
        loaded.tree, loaded.types,
        [&](const schema::SpectrumValue& value, schema::SpectrumRole role, Diagnostics& found) {
            return curves.curve(value, role, found);
        },
        find);
    const std::string bytes = exchange::exportScene(format, scene, target, loaded.diagnostics);
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(target).parent_path(), error);
    flushFileSystem(std::filesystem::path(target).parent_path().string());
    writeAtomically(target, bytes);
}

} // namespace abbe

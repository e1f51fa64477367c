// Exports: a changed scene that is sound is written for each of the other programs, and what was written can be
// imported again as a scene that is sound by its names and types.
#include "exchange/exporter/exporter.h"
#include "exchange/importer/importer.h"
#include "fuzz/targets/importing.h"
#include "scene/build_context.h"
#include "scene/registry.h"

#include <fstream>

using namespace abbe;

namespace {

// What of a file could be no export: more things than a test waits for.
constexpr std::size_t kMostInstances = 1000;

void requireNone(const Diagnostics& diagnostics, const SourceMap& sources, const char* what) {
    if (diagnostics.hasErrors()) std::fputs(formatHuman(diagnostics, sources).c_str(), stderr);
    fuzz::require(!diagnostics.hasErrors(), what);
}

void importAgain(const std::filesystem::path& file, const std::filesystem::path& scene,
                 const schema::TypeTable& types) {
    SourceMap sources;
    Diagnostics diagnostics;
    const auto* const format = exchange::importFormat(file);
    fuzz::require(format, "what was exported is not known as a file of its format");
    const auto text = exchange::importScene(*format, file, scene, sources, diagnostics);
    requireNone(diagnostics, sources, "what was exported cannot be imported");
    const auto document = parse(sources, sources.add("again.scene", *text), {}, diagnostics);
    schema::resolve(document, types, scene.parent_path(), diagnostics);
    requireNone(diagnostics, sources, "what was imported again is no scene");
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const schema::TypeTable types = makeTypeTable();
    static const fuzz::SideFolder folder;
    fuzz::reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        const FileId file = sources.add("fuzz.scene", fuzz::bytesOf(data, size));
        const auto tree = schema::resolve(parse(sources, file, {}, diagnostics), types, "/nowhere", diagnostics);
        BuildOptions options;
        options.geometry = false;
        if (diagnostics.hasErrors()) return;
        const BuiltScene built = buildScene(tree, types, options, diagnostics);
        if (diagnostics.hasErrors() || built.facts.instances > kMostInstances) return;
        CurveLibrary curves;
        const exchange::StatedScene scene(tree, types,
                                          [&](const schema::SpectrumValue& value, schema::SpectrumRole role,
                                              Diagnostics& found) { return curves.curve(value, role, found); });
        for (const exchange::ExportFormat& format : exchange::exportFormats()) {
            const auto target = std::filesystem::path(folder.path()) / ("fuzz" + std::string(format.extension));
            std::ofstream(target, std::ios::binary) << exchange::exportScene(format, scene, target, diagnostics);
            importAgain(target, std::filesystem::path(folder.path()) / "again.scene", types);
        }
        formatHuman(diagnostics, sources);
    });
    return 0;
}

// Exports: a changed scene that is sound is written for each of the other programs, and what was written can be
// imported again as a scene that is sound by its names and types.
#include "exchange/exporter/exporter.h"
#include "exchange/importer/importer.h"
#include "fuzz/targets/importing.h"
#include "scene/build_context.h"
#include "scene/registry.h"

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdlib.h>

using namespace abbe;

namespace {

// What of a file could be no export: more things than a test waits for.
constexpr std::size_t kMostInstances = 1000;

// Where exports go; every input writes the same names again.
class ExportFolder {
  public:
    ExportFolder() { fuzz::require(::mkdtemp(path_.data()), "no temporary folder"); }
    ~ExportFolder() {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    ExportFolder(const ExportFolder&) = delete;
    ExportFolder& operator=(const ExportFolder&) = delete;
    const std::string& path() const { return path_; }

  private:
    std::string path_ = (std::filesystem::temp_directory_path() / "abbe-fuzz-export-XXXXXX").string();
};

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

// One try to make a scene of a text and to export it. False where it has errors: `text` has lost their lines then, so
// that the next try may find a sound scene.
bool exportText(std::string& text, const schema::TypeTable& types, const std::filesystem::path& folder) {
    SourceMap sources;
    Diagnostics diagnostics;
    const FileId file = sources.add("fuzz.scene", text);
    const auto tree = schema::resolve(parse(sources, file, {}, diagnostics), types, "/nowhere", diagnostics);
    BuildOptions options;
    options.geometry = false;
    BuiltScene built;
    if (!diagnostics.hasErrors()) built = buildScene(tree, types, options, diagnostics);
    if (diagnostics.hasErrors()) {
        std::set<std::uint32_t> faulty;
        for (const Diagnostic& d : diagnostics.all())
            if (d.severity == Severity::error && d.span.file == file)
                faulty.insert(sources.lineColumn(file, d.span.begin).line);
        std::string kept;
        std::istringstream lines(text);
        std::uint32_t number = 1;
        for (std::string line; std::getline(lines, line); ++number)
            if (!faulty.contains(number)) kept += line + "\n";
        text = std::move(kept);
        return false;
    }
    if (built.facts.instances > kMostInstances) return true;
    CurveLibrary curves;
    const exchange::StatedScene scene(tree, types,
                                      [&](const schema::SpectrumValue& value, schema::SpectrumRole role,
                                          Diagnostics& found) { return curves.curve(value, role, found); });
    for (const exchange::ExportFormat& format : exchange::exportFormats()) {
        const auto target = folder / ("fuzz" + std::string(format.extension));
        std::ofstream(target, std::ios::binary) << exchange::exportScene(format, scene, target, diagnostics);
        // Stages of OpenUSD are read by a program of their own, which would have to start each time.
        if (target.extension() != ".usda") importAgain(target, folder / "again.scene", types);
    }
    formatHuman(diagnostics, sources);
    return true;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const schema::TypeTable types = makeTypeTable();
    static const ExportFolder folder;
    fuzz::reading([&] {
        constexpr int kTries = 4; // few changed texts are sound at once
        std::string text = fuzz::bytesOf(data, size);
        for (int i = 0; i < kTries && !exportText(text, types, folder.path()); ++i) {
        }
    });
    return 0;
}

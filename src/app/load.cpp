#include "app/load.h"

#include "base/stopwatch.h"
#include "base/work.h"
#include "exchange/importer/importer.h"
#include "parser/layer_files.h"
#include "parser/presets.h"
#include "scene/registry.h"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFrameParameter = "frame";

// Of the files that people wrote: that of the scene and those that it includes.
std::vector<const schema::Document*> documentsOf(const schema::SceneTree& tree) {
    std::vector<const schema::Document*> documents{tree.document.get()};
    for (const auto& [file, insert] : tree.inserts)
        if (insert.written) documents.push_back(insert.document.get());
    return documents;
}

} // namespace

std::vector<std::pair<const char*, std::string>> flagsOf(const SceneInput& input) {
    std::vector<std::pair<const char*, std::string>> flags;
    const auto add = [&](const char* flag, const std::vector<std::string>& values) {
        for (const std::string& value : values) flags.emplace_back(flag, value);
    };
    add("-D", input.defines);
    add("--variant", input.layers.variants);
    add("--set", input.layers.sets);
    add("--search", input.layers.search);
    return flags;
}

ExitCode LoadedScene::exitCode() const {
    if (!readable && !import) return ExitCode::system;
    return diagnostics.hasErrors() ? ExitCode::faulty : ExitCode::done;
}

bool LoadedScene::changesWithFrames() const {
    if (!tree.document) return false;
    if (import && import->isOfFrame()) return true;
    return asksForFrame() || std::ranges::any_of(documentsOf(tree), [](const schema::Document* document) {
               return std::ranges::any_of(document->nodes, [](const auto& node) { return node.name == "at"; });
           });
}

bool LoadedScene::asksForFrame() const {
    if (!tree.document) return false;
    return std::ranges::any_of(documentsOf(tree), [](const schema::Document* document) {
        return std::ranges::any_of(document->parameters,
                                   [](const auto& p) { return p.name == kFrameParameter && p.used; });
    });
}

namespace {

// Messages call a scene in a pack `shot.abz/shot.scene`.
std::optional<FileId> readPackedScene(LoadedScene& loaded, const std::string& path) {
    try {
        loaded.pack = std::make_unique<const UnpackedPack>(path);
    } catch (const PackFault& fault) {
        loaded.diagnostics.error("E0414", {loaded.sources.add(path, {}), 0, 0}, fault.what()).help =
            "copy it again, or make it again with `abbe pack`";
        return std::nullopt;
    }
    std::ifstream text(loaded.pack->scenePath(), std::ios::binary);
    return readSceneText(loaded.sources, path + "/" + loaded.pack->manifest().scene, text, loaded.diagnostics);
}

// Messages about the scene that was made call it `room.xml/room.scene`. A foreign scene with errors was readable, but
// makes none.
std::optional<FileId> readForeignScene(LoadedScene& loaded, const SceneInput& input,
                                       const exchange::ImportFormat& format) {
    const std::string& path = input.path;
    const exchange::ImportChoice choice{input.camera, input.frame};
    loaded.import = std::make_unique<const ImportedScene>(format, path, choice, loaded.sources, loaded.diagnostics);
    loaded.readable = loaded.import->text().has_value();
    // What was made names files of what it was made of.
    std::vector<std::string> search = input.layers.search;
    search.push_back(projectOf(fs::path(path).parent_path()).string());
    loaded.importReach = std::make_unique<const FileReach>(loaded.import->scenePath().parent_path(), search);
    if (!loaded.readable) return std::nullopt;
    std::istringstream text(*loaded.import->text());
    const std::string name = path + "/" + loaded.import->scenePath().filename().string();
    return readSceneText(loaded.sources, name, text, loaded.diagnostics);
}

std::optional<FileId> readText(LoadedScene& loaded, const SceneInput& input) {
    if (input.text) {
        std::istringstream stream(*input.text);
        return readSceneText(loaded.sources, input.path, stream, loaded.diagnostics);
    }
    if (input.fromStandardInput) return readSceneText(loaded.sources, input.path, std::cin, loaded.diagnostics);
    // Packages of USD are archives as packs are.
    if (const auto* format = exchange::importFormat(input.path)) return readForeignScene(loaded, input, *format);
    if (isPack(input.path)) return readPackedScene(loaded, input.path);
    return readSceneFile(loaded.sources, input.path, loaded.diagnostics);
}

} // namespace

std::unique_ptr<LoadedScene> loadScene(const SceneInput& input) {
    auto loaded = std::make_unique<LoadedScene>();
    Stopwatch watch;
    const WorkScope work(Work::reading);
    loaded->types = makeTypeTable();
    loaded->reach = std::make_unique<const FileReach>(fs::path(input.path).parent_path(), input.layers.search);
    const auto file = readText(*loaded, input);
    if (!file) return loaded;
    loaded->readable = true;
    loaded->text = *file;
    LayerOptions options{{}, input.layers.variants, input.layers.sets};
    for (const std::string& define : input.defines)
        if (auto override = readOverride(loaded->sources, define, loaded->diagnostics))
            options.defines.push_back(std::move(*override));
    if (input.frame)
        options.defines.push_back(
            {std::string(kFrameParameter), loaded->sources.add("--frames", std::to_string(*input.frame)), true});
    const auto scenePath = loaded->pack     ? loaded->pack->scenePath()
                           : loaded->import ? loaded->import->scenePath()
                                            : std::filesystem::path(input.path);
    const auto files = readLayerFiles(loaded->sources, *file, scenePath, options, loaded->diagnostics);
    addPresets(loaded->types, loaded->sources, loaded->diagnostics);
    loaded->parseSeconds = watch.lap();
    setWork(Work::checking);
    loaded->models = std::make_unique<PlacedModels>(loaded->sources, loaded->types, loaded->diagnostics);
    loaded->tree = schema::resolve(files, loaded->types, loaded->diagnostics,
                                   [&](schema::SceneTree& tree) { loaded->models->place(tree); });
    loaded->tree.frame = input.frame;
    loaded->resolveSeconds = watch.lap();
    return loaded;
}

// Packs, imported scenes and models consist of more files than the one that is looked at.
bool SceneLoader::isSame(const SceneInput& input) const {
    return last_ && last_->readable && !last_->pack && !last_->import && last_->tree.inserts.empty() &&
           !last_->asksForFrame() && !input.fromStandardInput && input.path == input_.path &&
           input.defines == input_.defines && input.layers == input_.layers &&
           input.frame.has_value() == input_.frame.has_value() && input.text == input_.text &&
           (input.text || identityOf(input.path) == file_);
}

std::shared_ptr<LoadedScene> SceneLoader::load(const SceneInput& input) {
    if (isSame(input)) {
        last_->tree.frame = input.frame;
        last_->diagnostics = diagnostics_;
        *last_->tree.namedFiles = named_;
        last_->parseSeconds = last_->resolveSeconds = 0;
        return last_;
    }
    file_ = identityOf(input.path);
    input_ = input;
    last_ = loadScene(input);
    diagnostics_ = last_->diagnostics;
    named_ = last_->tree.namedFiles ? *last_->tree.namedFiles : std::vector<schema::NamedFile>();
    ++timesRead_;
    return last_;
}

} // namespace abbe

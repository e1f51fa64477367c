#include "app/load.h"

#include "base/stopwatch.h"
#include "base/work.h"
#include "parser/parse.h"
#include "parser/presets.h"
#include "scene/registry.h"

#include <algorithm>
#include <iostream>

namespace abbe {

namespace {

constexpr std::string_view kFrameParameter = "frame";

} // namespace

ExitCode LoadedScene::exitCode() const {
    if (!readable) return ExitCode::system;
    return diagnostics.hasErrors() ? ExitCode::faulty : ExitCode::done;
}

bool LoadedScene::changesWithFrames() const {
    if (!tree.document) return false;
    const schema::Document& document = *tree.document;
    return std::ranges::any_of(document.nodes, [](const auto& node) { return node.name == "at"; }) ||
           std::ranges::any_of(document.parameters, [](const auto& p) { return p.name == kFrameParameter && p.used; });
}

std::unique_ptr<LoadedScene> loadScene(const SceneInput& input) {
    auto loaded = std::make_unique<LoadedScene>();
    Stopwatch watch;
    const WorkScope work(Work::reading);
    loaded->types = makeTypeTable();
    const auto file = input.fromStandardInput
                          ? readSceneText(loaded->sources, input.path, std::cin, loaded->diagnostics)
                          : readSceneFile(loaded->sources, input.path, loaded->diagnostics);
    if (!file) return loaded;
    loaded->readable = true;
    ParseOptions options;
    for (const std::string& define : input.defines)
        if (auto override = readOverride(loaded->sources, define, loaded->diagnostics))
            options.overrides.push_back(std::move(*override));
    if (input.frame)
        options.overrides.push_back(
            {std::string(kFrameParameter), loaded->sources.add("--frames", std::to_string(*input.frame)), true});
    const auto document = parse(loaded->sources, *file, options, loaded->diagnostics);
    addPresets(loaded->types, loaded->sources, loaded->diagnostics);
    loaded->parseSeconds = watch.lap();
    setWork(Work::checking);
    loaded->tree =
        schema::resolve(document, loaded->types, std::filesystem::path(input.path).parent_path(), loaded->diagnostics);
    loaded->tree.frame = input.frame;
    loaded->resolveSeconds = watch.lap();
    return loaded;
}

} // namespace abbe

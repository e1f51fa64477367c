#include "app/explain_effects.h"
#include "app/options.h"
#include "base/diagnostic_catalogue.h"
#include "parser/presets.h"
#include "scene/registry.h"
#include "schema/describe.h"

#include <algorithm>
#include <filesystem>

namespace abbe {

namespace {

bool looksLikeFile(const std::string& topic) {
    std::error_code error;
    return topic.ends_with(".scene") || topic.find('/') != std::string::npos ||
           std::filesystem::is_regular_file(topic, error);
}

ExitCode explainScene(const ExplainOptions& options, const CommonOptions& common) {
    const auto loaded = loadScene({options.topic, options.defines});
    BuildOptions build;
    build.geometry = false;
    BuiltScene built;
    if (loaded->readable) built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    common.console.report(loaded->diagnostics, loaded->sources);
    if (loaded->exitCode() != ExitCode::done) return loaded->exitCode();
    common.console.data(common.json ? effectsJson(*loaded, built).text(true) + "\n" : effectsText(*loaded, built));
    return ExitCode::done;
}

} // namespace

ExitCode run(const ExplainOptions& options, const CommonOptions& common) {
    if (options.effects && options.topic.empty()) {
        common.console.data(allEffectsText());
        return ExitCode::done;
    }
    if (options.effects || looksLikeFile(options.topic)) return explainScene(options, common);
    schema::TypeTable types = makeTypeTable();
    SourceMap sources;
    Diagnostics diagnostics;
    addPresets(types, sources, diagnostics);
    const schema::Explanation explanation = schema::explain(types, options.topic);
    if (explanation.found) {
        common.console.data(explanation.text);
        return ExitCode::done;
    }
    common.console.line(explanation.text);
    return ExitCode::faulty;
}

} // namespace abbe

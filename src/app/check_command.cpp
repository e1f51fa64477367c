#include "app/options.h"
#include "base/diagnostic.h"
#include "io/file.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

std::unique_ptr<LoadedScene> checkScene(const SceneInput& input, bool textures = false) {
    auto loaded = loadScene(input);
    BuildOptions options;
    options.geometry = false;
    options.textures = textures;
    if (loaded->readable) buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
    return loaded;
}

// Applies what can be applied, again and again until nothing is left: one fix may uncover the next.
std::size_t fixScene(const SceneInput& input) {
    constexpr int kRounds = 64; // each mends a thousand faults of a kind
    std::size_t applied = 0;
    for (int round = 0; round < kRounds; ++round) {
        const auto loaded = checkScene(input);
        if (!loaded->readable) return applied;
        const FileId file{0};
        const FixResult fixed = applyFixes(loaded->sources.text(file), file, loaded->diagnostics);
        if (fixed.applied == 0) return applied;
        applied += fixed.applied;
        writeAtomically(input.path, fixed.text);
    }
    return applied;
}

constexpr const char* kStandardInput = "-";

SceneInput checkedInput(const std::string& path, const CheckOptions& options) {
    if (path != kStandardInput) return {path, options.defines};
    return {options.standsFor.empty() ? "<stdin>" : options.standsFor, options.defines, true};
}

ExitCode checkOne(const SceneInput& input, const CheckOptions& options, const Console& console) {
    const std::size_t fixed = options.fix ? fixScene(input) : 0;
    const auto loaded = checkScene(input, options.textures);
    console.report(loaded->diagnostics, loaded->sources);
    if (console.format() == MessageFormat::human && !options.quiet) {
        if (fixed > 0) console.line(fmt::format("{}: {} repaired", input.path, fixed));
        if (loaded->diagnostics.all().empty()) console.line(fmt::format("{}: no errors, no warnings", input.path));
    }
    if (loaded->exitCode() != ExitCode::done) return loaded->exitCode();
    return options.strict && loaded->diagnostics.warningCount() > 0 ? ExitCode::threshold : ExitCode::done;
}

// The one that matters more when several files fail in different ways.
ExitCode worse(ExitCode a, ExitCode b) {
    const auto rank = [](ExitCode c) {
        return c == ExitCode::done ? 0 : c == ExitCode::threshold ? 1 : c == ExitCode::faulty ? 2 : 3;
    };
    return rank(a) >= rank(b) ? a : b;
}

} // namespace

ExitCode run(const CheckOptions& options, const CommonOptions& common) {
    ExitCode result = ExitCode::done;
    for (const std::string& path : options.paths)
        result = worse(result, checkOne(checkedInput(path, options), options, common.console));
    return result;
}

} // namespace abbe

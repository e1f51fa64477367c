// Snippets of scene language as whole scenes: what they leave out is put in, and they are checked, built and rendered.
#pragma once

#include "app/load.h"
#include "base/diagnostic_format.h"
#include "rendering/path_tracer.h"
#include "scene/build.h"
#include "scene_checks/scene_checks.h"
#include "support/scene_test_film.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace abbe::test {

inline const std::filesystem::path kSourceFolder = ABBE_SOURCE_DIR;

// What a snippet names without defining it: a definition by name (tests/snippets/names.scene) or a file by its ending.
class StandIns {
  public:
    StandIns() {
        std::ifstream file(kSourceFolder / "tests/snippets/names.scene");
        for (std::string line; std::getline(file, line);) {
            std::istringstream words(line);
            std::string kind, name;
            words >> kind >> name;
            if (schema::findKind(kind)) definitions_[name] = line;
        }
        REQUIRE(definitions_.size() > 3);
    }
    // Adds to the text or the folder what the error misses; false if it is another error.
    bool supply(const Diagnostic& d, const std::filesystem::path& folder, std::string& text) {
        if (d.code == "E0601") return text += "\ncamera { from 0 1 4; look-at 0 0.5 0 }", true;
        if (d.code == "E0610") return text += "\nlight sky { luminance 1000 nits }", true;
        const std::size_t first = d.message.find('`') + 1, last = d.message.rfind('`');
        const std::string name = first < last ? d.message.substr(first, last - first) : "";
        const bool missing = d.code == "E0202" || d.code == "E0632" || d.code == "E0655";
        if (missing && definitions_.contains(name)) return text += "\n" + definitions_[name], true;
        if (d.code != "E0401") return false;
        std::string written = name;
        if (const std::size_t tile = written.find("<UDIM>"); tile != std::string::npos)
            written.replace(tile, 6, "1001");
        const std::filesystem::path own = kSourceFolder / "tests/snippets" / std::filesystem::path(written).filename();
        const std::filesystem::path model =
            std::filesystem::exists(own)
                ? own
                : kSourceFolder / "tests/snippets" / ("any" + std::filesystem::path(written).extension().string());
        if (!std::filesystem::exists(model) || std::filesystem::exists(folder / written)) return false;
        std::filesystem::create_directories((folder / written).parent_path());
        std::filesystem::copy_file(model, folder / written);
        return true;
    }

  private:
    std::map<std::string, std::string> definitions_;
};

// Of what the program says of a snippet: errors and warnings, but that something is never used.
inline std::vector<Diagnostic> complaints(const Diagnostics& diagnostics) {
    std::vector<Diagnostic> found;
    for (const Diagnostic& d : diagnostics.all())
        if (d.code != "W0201" && d.code != "W0205") found.push_back(d);
    return found;
}

struct SnippetVerdict {
    std::string codes, report;
    bool rendered = false; // a sample of each of 4 x 4 pixels
};

// A picture of 4 by 4 pixels, one sample each: whatever the scene needs simulated is called once.
inline void renderFew(const schema::SceneTree& tree, const schema::TypeTable& types, Diagnostics& diagnostics) {
    BuildOptions options;
    options.size = Vec2i{4, 4};
    options.samples = 1;
    options.pilot = 0;
    const BuiltScene built = buildScene(tree, types, options, diagnostics);
    if (diagnostics.hasErrors()) return;
    RecordingFilm film(built.film, 1);
    makePathTracer(built.scene.effects)->render(built.scene, film, renderSettings(built.render), {});
}

// Of a text in `folder`, with what it misses supplied, so far as that is known.
inline SnippetVerdict checkSnippet(std::string text, const std::filesystem::path& folder, StandIns& standIns) {
    for (int round = 0;; ++round) {
        std::ofstream(folder / "snippet.scene") << text;
        const auto loaded = loadScene({(folder / "snippet.scene").string(), {}});
        const auto supplied = [&] {
            bool any = false;
            for (const Diagnostic& d : complaints(loaded->diagnostics))
                any = any || (round < 20 && standIns.supply(d, folder, text));
            return any;
        };
        if (supplied()) continue; // before the scene is built in vain
        BuildOptions options;
        options.geometry = false;
        const BuiltScene built = buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
        if (supplied()) continue;
        checkWholeScene(built, loaded->tree, CheckDepth::surfaces, loaded->diagnostics);
        SnippetVerdict verdict;
        for (const Diagnostic& d : complaints(loaded->diagnostics))
            verdict.codes += (verdict.codes.empty() ? "" : " ") + d.code;
        if (!loaded->diagnostics.hasErrors()) {
            Diagnostics again;
            renderFew(loaded->tree, loaded->types, again);
            for (const Diagnostic& d : again.all()) loaded->diagnostics.add(d);
            verdict.rendered = !again.hasErrors();
        }
        verdict.report = formatHuman(loaded->diagnostics, loaded->sources);
        return verdict;
    }
}

struct SnippetFolder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("abbe-snippets-{}", getpid());
    SnippetFolder() { std::filesystem::create_directories(path); }
    ~SnippetFolder() { std::filesystem::remove_all(path); }
};

} // namespace abbe::test

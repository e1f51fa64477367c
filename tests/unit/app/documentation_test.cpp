// Every snippet of scene language in the documentation is what the program accepts. How snippets are marked is in
// docs/testing.md.
#include "app/load.h"
#include "base/diagnostic_format.h"
#include "scene/build.h"

#include <algorithm>
#include <array>
#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <unistd.h>

using namespace abbe;
namespace fs = std::filesystem;

namespace {

const fs::path kSource = ABBE_SOURCE_DIR;

struct DocumentedSnippet {
    std::string page;
    int line = 0;     // of its first line
    std::string mark; // behind `kdl`: "", "in camera", "wrong E0201"
    std::string text;
    bool marked = false;
    bool other = false; // of another language, as its fence says
};

std::string firstWordOf(const std::string& text) {
    std::istringstream words(text);
    std::string word;
    words >> word;
    return word.starts_with("/-") ? word.substr(2) : word;
}

// A snippet without a mark that begins like a scene. Words in capitals stand for something: `atmosphere MEDIUM`.
bool looksLikeScene(const std::string& text) {
    const std::string word = firstWordOf(text);
    if (!schema::findKind(word) && word != "scene" && word != "param" && word != "transform") return false;
    int capitals = 0;
    for (const char c : text) {
        capitals = c >= 'A' && c <= 'Z' ? capitals + 1 : 0;
        if (capitals == 3) return false;
    }
    return true;
}

std::string withoutIndent(const std::string& line, std::size_t indent) {
    return line.size() > indent ? line.substr(indent) : std::string();
}

// The fences and the indented blocks of a page.
std::vector<DocumentedSnippet> snippetsOf(const fs::path& page) {
    std::ifstream file(page);
    std::vector<DocumentedSnippet> found;
    DocumentedSnippet open;
    enum class Within { prose, fence, indented } within = Within::prose;
    const auto close = [&] {
        if (within != Within::prose) found.push_back(open);
        within = Within::prose;
    };
    bool afterBlank = true;
    int number = 0;
    for (std::string line; std::getline(file, line); afterBlank = line.empty()) {
        ++number;
        const std::size_t indent = line.find_first_not_of(' ');
        const bool fence = indent != std::string::npos && line.compare(indent, 3, "```") == 0;
        if (within == Within::fence) {
            if (fence)
                close();
            else
                open.text += withoutIndent(line, 0) + "\n";
            continue;
        }
        if (within == Within::indented && (indent == std::string::npos || indent >= 4)) {
            open.text += withoutIndent(line, 4) + "\n";
            continue;
        }
        close();
        open = {fs::relative(page, kSource).string(), number, "", "", false, false};
        if (fence) {
            const std::string mark = line.substr(indent + 3);
            open.marked = mark == "kdl" || mark.starts_with("kdl ");
            open.other = !open.marked && !mark.empty();
            open.mark = open.marked && mark.size() > 4 ? mark.substr(4) : "";
            ++open.line;
            within = Within::fence;
        } else if (afterBlank && indent != std::string::npos && indent >= 4) {
            open.text = withoutIndent(line, 4) + "\n";
            within = Within::indented;
        }
    }
    close();
    return found;
}

std::vector<DocumentedSnippet> allSnippets() {
    std::vector<fs::path> pages = {kSource / "README.md"};
    for (const char* folder : {"docs", "scenes"})
        for (const auto& entry : fs::recursive_directory_iterator(kSource / folder))
            if (entry.path().extension() == ".md") pages.push_back(entry.path());
    std::ranges::sort(pages);
    std::vector<DocumentedSnippet> all;
    for (const fs::path& page : pages)
        for (DocumentedSnippet& s : snippetsOf(page)) all.push_back(std::move(s));
    return all;
}

// What a snippet names without defining it: a definition by name (tests/snippets/names.scene) or a file by its ending.
class StandIns {
  public:
    StandIns() {
        std::ifstream file(kSource / "tests/snippets/names.scene");
        for (std::string line; std::getline(file, line);) {
            std::istringstream words(line);
            std::string kind, name;
            words >> kind >> name;
            if (schema::findKind(kind)) definitions_[name] = line;
        }
        REQUIRE(definitions_.size() > 3);
    }
    // Adds to the text or the folder what the error misses; false if it is another error.
    bool supply(const Diagnostic& d, const fs::path& folder, std::string& text) {
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
        const fs::path own = kSource / "tests/snippets" / fs::path(written).filename();
        const fs::path model =
            fs::exists(own) ? own : kSource / "tests/snippets" / ("any" + fs::path(written).extension().string());
        if (!fs::exists(model) || fs::exists(folder / written)) return false;
        fs::create_directories((folder / written).parent_path());
        fs::copy_file(model, folder / written);
        return true;
    }

  private:
    std::map<std::string, std::string> definitions_;
};

// The text as a scene of its own: of a small picture, as surfaces are diced by its pixels.
std::string wholeText(const DocumentedSnippet& s) {
    std::string text = s.text;
    if (s.mark.starts_with("in ")) text = s.mark.substr(3) + " {\n" + text + "}\n";
    if (text.find("film") == std::string::npos) text += "\nfilm { size 64 36 }\n";
    return text.find("scene 1") == std::string::npos ? "scene 1\n" + text : text;
}

// Of what the program says of the snippet: errors and warnings, but that something is never used.
std::vector<Diagnostic> complaints(const Diagnostics& diagnostics) {
    std::vector<Diagnostic> found;
    for (const Diagnostic& d : diagnostics.all())
        if (d.code != "W0201" && d.code != "W0205") found.push_back(d);
    return found;
}

struct Verdict {
    std::string codes, report;
};

Verdict check(const DocumentedSnippet& snippet, const fs::path& folder, StandIns& standIns) {
    std::string text = wholeText(snippet);
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
        buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
        if (supplied()) continue;
        std::string codes;
        for (const Diagnostic& d : complaints(loaded->diagnostics)) codes += (codes.empty() ? "" : " ") + d.code;
        return {codes, formatHuman(loaded->diagnostics, loaded->sources)};
    }
}

struct SnippetFolder {
    fs::path path = fs::temp_directory_path() / fmt::format("abbe-snippets-{}", getpid());
    SnippetFolder() { fs::create_directories(path); }
    ~SnippetFolder() { fs::remove_all(path); }
};

} // namespace

TEST_CASE("snippets of scene language are marked as such") {
    for (const DocumentedSnippet& s : allSnippets())
        if (!s.marked && !s.other && looksLikeScene(s.text))
            FAIL_CHECK(s.page << ":" << s.line << ": write it into a fence ```kdl\n" << s.text);
}

TEST_CASE("snippets of scene language are accepted, or wrong in the way they are said to be") {
    StandIns standIns;
    std::size_t count = 0;
    for (const DocumentedSnippet& s : allSnippets()) {
        if (!s.marked) continue;
        ++count;
        const SnippetFolder folder;
        const Verdict verdict = check(s, folder.path, standIns);
        const std::string expected = s.mark.starts_with("wrong ") ? s.mark.substr(6) : "";
        CHECK_MESSAGE(verdict.codes == expected, s.page << ":" << s.line << "\n" << wholeText(s) << verdict.report);
    }
    CHECK(count >= 40);
}

// Every snippet of scene language in the documentation is what the program accepts. How snippets are marked is in
// docs/testing.md.
#include "snippet_scene.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <fstream>
#include <sstream>

using namespace abbe;
using namespace abbe::test;
namespace fs = std::filesystem;

namespace {

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
        open = {fs::relative(page, kSourceFolder).string(), number, "", "", false, false};
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
    std::vector<fs::path> pages = {kSourceFolder / "README.md"};
    for (const char* folder : {"docs", "scenes"})
        for (const auto& entry : fs::recursive_directory_iterator(kSourceFolder / folder))
            if (entry.path().extension() == ".md") pages.push_back(entry.path());
    std::ranges::sort(pages);
    std::vector<DocumentedSnippet> all;
    for (const fs::path& page : pages)
        for (DocumentedSnippet& s : snippetsOf(page)) all.push_back(std::move(s));
    return all;
}

// The text as a scene of its own: of a small picture, as surfaces are diced by its pixels.
std::string wholeText(const DocumentedSnippet& s) {
    std::string text = s.text;
    if (s.mark.starts_with("in ")) text = s.mark.substr(3) + " {\n" + text + "}\n";
    if (text.find("film") == std::string::npos) text += "\nfilm { size 64 36 }\n";
    return text.find("scene 1") == std::string::npos ? "scene 1\n" + text : text;
}

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
        const SnippetVerdict verdict = checkSnippet(wholeText(s), folder.path, standIns);
        const std::string expected = s.mark.starts_with("wrong ") ? s.mark.substr(6) : "";
        CHECK_MESSAGE(verdict.codes == expected, s.page << ":" << s.line << "\n" << wholeText(s) << verdict.report);
        if (!expected.starts_with('E'))
            CHECK_MESSAGE(verdict.rendered, s.page << ":" << s.line << " does not render\n" << verdict.report);
    }
    CHECK(count >= 40);
}

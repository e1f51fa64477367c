#include "app/command_tree.h"
#include "app/man_page.h"
#include "app/options.h"
#include "app/shell_completion.h"
#include "base/source.h"
#include "io/file.h"
#include "parser/presets.h"
#include "scene/registry.h"
#include "schema/describe.h"

#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

namespace fs = std::filesystem;

// The language with its library; the texts of the library are in `sources`.
struct Language {
    Language() {
        Diagnostics diagnostics;
        addPresets(types, sources, diagnostics);
    }
    SourceMap sources;
    schema::TypeTable types = makeTypeTable();
};

std::string referenceText(std::string_view what) {
    const Language language;
    if (what == "json") return schema::schemaJson(language.types);
    const CommandInfo tree = commandTree();
    if (what == "man") return manPage(tree, ABBE_VERSION);
    const auto topics = schema::explainableWords(language.types);
    if (what == "bash") return bashCompletion(tree, topics);
    return what == "zsh" ? zshCompletion(tree, topics) : fishCompletion(tree, topics);
}

void writeInto(const fs::path& folder, const fs::path& name, const std::string& text) {
    const fs::path path = folder / name;
    fs::create_directories(path.parent_path());
    writeAtomically(path.string(), text);
}

} // namespace

ExitCode run(const ReferenceOptions& options, const CommonOptions& common) {
    try {
        if (options.what == "pages") {
            const Language language;
            for (const schema::ReferencePage& page : schema::referencePages(language.types))
                writeInto(options.folder, page.file, page.text);
        } else if (options.what == "share") {
            writeInto(options.folder, "man/man1/abbe.1", referenceText("man"));
            writeInto(options.folder, "bash-completion/completions/abbe", referenceText("bash"));
            writeInto(options.folder, "zsh/site-functions/_abbe", referenceText("zsh"));
            writeInto(options.folder, "fish/vendor_completions.d/abbe.fish", referenceText("fish"));
        } else {
            common.console.data(referenceText(options.what));
        }
    } catch (const fs::filesystem_error& e) {
        common.console.error(fmt::format("cannot make the folder `{}`: {}", e.path1().string(), e.code().message()));
        return ExitCode::system;
    }
    return ExitCode::done;
}

} // namespace abbe

#include "app/identity.h"
#include "base/source.h"
#include "command_line/command_tree.h"
#include "command_line/parser.h"
#include "commands/command_table.h"
#include "io/file.h"
#include "parser/presets.h"
#include "scene/registry.h"
#include "schema/describe.h"
#include "schema/json_schema.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kReferenceHelp = R"(Writes what the program makes of its own tables: pages, man page, completions.

  pages FOLDER      the reference of the scene language, a page of Markdown for each kind
  json              kinds, types, properties, units and data for editors and exporters
  json-schema       JSON Schema of scenes as `abbe fmt --tree` prints them
  textmate          the TextMate grammar by which editors colour scene files
  man               the manual page, for `man -l`
  bash, zsh, fish   completion for that shell
  share FOLDER      man page and completions where systems look for them below FOLDER

Examples:
  abbe reference pages docs/reference
  abbe reference man >abbe.1
  source <(abbe reference bash)
  abbe reference share ~/.local/share)";

namespace {

using What = ReferenceOptions::What;

constexpr Choice<What> kWhats[] = {
    {"pages", What::pages},       {"json", What::json}, {"json-schema", What::jsonSchema},
    {"textmate", What::textmate}, {"man", What::man},   {"bash", What::bash},
    {"zsh", What::zsh},           {"fish", What::fish}, {"share", What::share}};

} // namespace

void addArguments(Arguments& a, ReferenceOptions& o) {
    a.choice<What>("what", o.what, {std::begin(kWhats), std::end(kWhats)}, "What is written").require();
    a.argument("folder", &o.folder, "Where pages and share are written");
    a.afterwards([&o]() -> std::optional<ArgumentFault> {
        const bool needsFolder = o.what == What::pages || o.what == What::share;
        const std::string_view name = std::ranges::find(kWhats, o.what, &Choice<What>::value)->word;
        if (needsFolder && o.folder.empty())
            return ArgumentFault{"folder", fmt::format("`{}` needs a folder to write to", name)};
        if (!needsFolder && !o.folder.empty())
            return ArgumentFault{"folder", fmt::format("`{}` is written to standard output", name)};
        return std::nullopt;
    });
}

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

std::string referenceText(What what) {
    const Language language;
    if (what == What::json) return schema::schemaJson(language.types);
    if (what == What::jsonSchema) return schema::jsonSchema(language.types);
    if (what == What::textmate) return schema::textMateGrammar(language.types);
    const CommandInfo tree = commandTree(commandTable());
    if (what == What::man) return manPage(tree, versionNumber());
    const auto topics = schema::explainableWords(language.types);
    if (what == What::bash) return bashCompletion(tree, topics);
    return what == What::zsh ? zshCompletion(tree, topics) : fishCompletion(tree, topics);
}

void writeInto(const fs::path& folder, const fs::path& name, const std::string& text) {
    const fs::path path = folder / name;
    fs::create_directories(path.parent_path());
    writeAtomically(path.string(), text);
}

} // namespace

ExitCode run(const ReferenceOptions& options, const CommonOptions& common) {
    try {
        if (options.what == What::pages) {
            const Language language;
            for (const schema::ReferencePage& page : schema::referencePages(language.types))
                writeInto(options.folder, page.file, page.text);
        } else if (options.what == What::share) {
            writeInto(options.folder, "man/man1/abbe.1", referenceText(What::man));
            writeInto(options.folder, "bash-completion/completions/abbe", referenceText(What::bash));
            writeInto(options.folder, "zsh/site-functions/_abbe", referenceText(What::zsh));
            writeInto(options.folder, "fish/vendor_completions.d/abbe.fish", referenceText(What::fish));
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

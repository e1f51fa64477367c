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

const char* const kReferenceHelp = R"(Writes what the program makes of its own tables: pages, man pages, completions.

  pages FOLDER      the reference of the scene language, a page of Markdown for each kind
  json              kinds, types, properties, units and data for editors and exporters
  json-schema       JSON Schema of scenes as `abbe fmt --tree` prints them
  textmate          the TextMate grammar by which editors colour scene files
  man [COMMAND]     the manual page of the program, or of a command, for `man -l`
  bash, zsh, fish   completion for that shell
  share FOLDER      man pages and completions where systems look for them below FOLDER

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
    a.argument("where", &o.where, "Folder that pages and share are written to; command whose page man prints");
    a.afterwards([&o]() -> std::optional<ArgumentFault> {
        const bool needsFolder = o.what == What::pages || o.what == What::share;
        const std::string_view name = std::ranges::find(kWhats, o.what, &Choice<What>::value)->word;
        if (needsFolder && o.where.empty())
            return ArgumentFault{"where", fmt::format("`{}` needs a folder to write to", name)};
        if (!needsFolder && o.what != What::man && !o.where.empty())
            return ArgumentFault{"where", fmt::format("`{}` is written to standard output", name)};
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
    const auto topics = schema::explainableWords(language.types);
    if (what == What::bash) return bashCompletion(tree, topics);
    return what == What::zsh ? zshCompletion(tree, topics) : fishCompletion(tree, topics);
}

std::vector<ManPage> allManPages() { return manPages(commandTree(commandTable()), versionNumber()); }

ExitCode printManPage(const std::string& command, const Console& console) {
    const std::string name = command.empty() ? "abbe" : "abbe-" + command;
    const auto pages = allManPages();
    const auto page = std::ranges::find(pages, name, &ManPage::name);
    if (page == pages.end()) {
        console.error(fmt::format("there is no command `{}`; `abbe help` lists all", command));
        return ExitCode::usage;
    }
    console.data(page->text);
    return ExitCode::done;
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
                writeInto(options.where, page.file, page.text);
        } else if (options.what == What::share) {
            for (const ManPage& page : allManPages())
                writeInto(options.where, "man/man1/" + page.name + ".1", page.text);
            writeInto(options.where, "bash-completion/completions/abbe", referenceText(What::bash));
            writeInto(options.where, "zsh/site-functions/_abbe", referenceText(What::zsh));
            writeInto(options.where, "fish/vendor_completions.d/abbe.fish", referenceText(What::fish));
        } else if (options.what == What::man) {
            return printManPage(options.where, common.console);
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

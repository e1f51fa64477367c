#include "app/command_line_reference.h"

#include <CLI/CLI.hpp>

namespace abbe {

const char* const kReferenceHelp = R"(Writes what the program makes of its own tables: pages, man page, completions.

  pages FOLDER      the reference of the scene language, a page of Markdown for each kind
  json              kinds, types, properties and units for editors and exporters
  man               the manual page, for `man -l`
  bash, zsh, fish   completion for that shell
  share FOLDER      man page and completions where systems look for them below FOLDER

Examples:
  abbe reference pages docs/reference
  abbe reference man >abbe.1
  source <(abbe reference bash)
  abbe reference share ~/.local/share)";

void addReferenceArguments(CLI::App& command, ReferenceOptions& options) {
    command.add_option("what", options.what, "What is written")
        ->required()
        ->check(CLI::IsMember({"pages", "json", "man", "bash", "zsh", "fish", "share"}).description(""))
        ->type_name("pages|json|man|bash|zsh|fish|share");
    command.add_option("folder", options.folder, "Where pages and share are written")->type_name("");
    command.callback([&options] {
        const bool needsFolder = options.what == "pages" || options.what == "share";
        if (needsFolder && options.folder.empty())
            throw CLI::ValidationError("folder", "`" + options.what + "` needs a folder to write to");
        if (!needsFolder && !options.folder.empty())
            throw CLI::ValidationError("folder", "`" + options.what + "` is written to standard output");
    });
}

} // namespace abbe

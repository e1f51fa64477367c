#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "language_server/server.h"
#include "parser/parse.h"

#include <unistd.h>

namespace abbe {

const char* const kLspHelp = R"(Serves an editor: diagnostics, completion, explanations and renaming as one writes.

Examples:
  abbe lsp   as an editor starts it, which talks to it over standard input and output (docs/editors.md))";

void addArguments(Arguments& a, LspOptions& o) {
    a.flag("--stdio", &o.stdio, "What it does anyway; some editors ask for it");
}

ExitCode run(const LspOptions&, const CommonOptions&) {
    return lsp::runLanguageServer(STDIN_FILENO, STDOUT_FILENO, formatted) == 0 ? ExitCode::done : ExitCode::faulty;
}

} // namespace abbe

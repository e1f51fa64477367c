#include "command_line/parser.h"
#include "commands/command_table.h"

#include <fmt/format.h>

namespace abbe {

const char* const kHelpHelp =
    R"(Lists all commands, or explains one of them, or a word of the scene language.

Examples:
  abbe help
  abbe help render
  abbe help volume make
  abbe help camera                             the same as `abbe explain camera`)";

void addArguments(Arguments& a, HelpOptions& o) {
    a.argument("topic", &o.topic, "A command, or words of the scene language");
}

ExitCode run(const HelpOptions& options, const CommonOptions& common) {
    if (const auto text = commandHelp(commandTable(), options.topic)) {
        common.console.data(*text);
        return ExitCode::done;
    }
    ExplainOptions words;
    words.topic = fmt::format("{}", fmt::join(options.topic, " "));
    return run(words, common);
}

} // namespace abbe

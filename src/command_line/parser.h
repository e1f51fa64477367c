// From argv to a command, and from a table of commands to the tree that help and completions are made of.
#pragma once

#include "command_line/command.h"
#include "command_line/command_tree.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace abbe {

struct CommandLine {
    std::unique_ptr<Command> command;
    CommonOptions common;
};

// The program ends here: help and version (code done, text for stdout), or a wrong command line (for stderr).
struct EarlyEnd {
    ExitCode code = ExitCode::done;
    std::string text;
};

// `arguments` without the program's name. Without the name of a command they are those of `render`.
std::variant<CommandLine, EarlyEnd> readCommandLine(const CommandTable&, std::span<const char* const> arguments);
std::variant<CommandLine, EarlyEnd> readCommandLine(const CommandTable&, const std::vector<std::string>& arguments);

// The root is "abbe" itself. Made anew by each call.
CommandInfo commandTree(const CommandTable&);

// What `abbe help …` prints; nothing if its words are no command: they are words of the scene language.
std::optional<std::string> commandHelp(const CommandTable&, std::span<const std::string> words);

// Whether the word is the name of a command.
bool isCommand(const CommandTable&, std::string_view word);
// The command that is probably meant by a word that is neither one nor a file; or empty.
std::string commandSuggestion(const CommandTable&, const std::string& word);

} // namespace abbe

// From argv to options. CLI11 is hidden in command_line.cpp, because it is slow to compile.
#pragma once

#include "app/exit_code.h"
#include "app/options.h"

#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace abbe {

struct Command {
    Options options;
    CommonOptions common;
};

// The program ends here: help and version (code done, text for stdout), or a wrong command line (for stderr).
struct EarlyEnd {
    ExitCode code = ExitCode::done;
    std::string text;
};

// Whether the word is the name of a command.
bool isCommand(std::string_view word);
// The command that is probably meant by a word that is neither one nor a file; or empty.
std::string commandSuggestion(const std::string& word);

// `arguments` without the program's name.
std::variant<Command, EarlyEnd> readCommandLine(std::span<const char* const> arguments);

} // namespace abbe

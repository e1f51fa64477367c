// `abbe help`: all commands, one of them, or a word of the scene language.
#pragma once

#include "command_line/command.h"

#include <string>
#include <vector>

namespace abbe {

struct HelpOptions {
    std::vector<std::string> topic; // a command, or words of the language; empty: all commands
};

extern const char* const kHelpHelp;
void addArguments(Arguments&, HelpOptions&);
ExitCode run(const HelpOptions&, const CommonOptions&);

} // namespace abbe

// abbe(1): all commands and flags for `man`, made of the tables of the command line.
#pragma once

#include "command_line/command_tree.h"

#include <string>

namespace abbe {

// In the man macros of troff, UTF-8. `version` is that of the program: "0.1.0".
std::string manPage(const CommandInfo& root, const std::string& version);

} // namespace abbe

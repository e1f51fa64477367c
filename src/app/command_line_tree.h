// What the library's parser knows about itself: its commands as data, their help, and what to say of a wrong line.
#pragma once

#include "app/command_tree.h"

#include <string>

namespace CLI {
class App;
class ParseError;
} // namespace CLI

namespace abbe {

// The root and everything below it.
CommandInfo describeCommands(const CLI::App& root);

// The command that was chosen, or the action of one that has some; the root if there is none.
const CLI::App& chosenCommand(const CLI::App& root);

// "abbe render", "abbe volume info".
std::string fullName(const CLI::App& command);

// What `--help` of a command prints.
std::string helpText(const CLI::App& command);

// What was wrong, with the flag that was probably meant.
std::string errorText(const CLI::App& root, const CLI::ParseError&);

} // namespace abbe

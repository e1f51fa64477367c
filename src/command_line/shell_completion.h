// Completion of commands, flags and words of the language in shells, made of the tables of the command line.
#pragma once

#include "command_line/command_tree.h"

#include <string>
#include <vector>

namespace abbe {

// Scripts for the shell to read; `topics` are what `abbe explain` knows, sorted.
std::string bashCompletion(const CommandInfo& root, const std::vector<std::string>& topics);
std::string zshCompletion(const CommandInfo& root, const std::vector<std::string>& topics);
std::string fishCompletion(const CommandInfo& root, const std::vector<std::string>& topics);

// What stands where the command line has an argument or a value.
enum class Expected : unsigned char { nothing, anything, file, word, topic };
Expected expectedAt(const ArgumentInfo&); // `word`: one of its choices
Expected expectedOf(const FlagInfo&);

// How names of the files end that an argument means: ".scene"; empty: any file.
std::string fileEnding(const ArgumentInfo&);

// In single quotes, as bash and zsh read them.
std::string singleQuoted(const std::string&);

} // namespace abbe

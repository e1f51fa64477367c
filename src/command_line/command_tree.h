// The commands and flags as plain data, read from the library's parser: what help, man pages and completions are made
// of. Nothing else lists them. And what is made of them: abbe(1) and its fellows for `man`, and completion of commands,
// flags and words of the language in shells.
#pragma once

#include <string>
#include <vector>

namespace abbe {

struct FlagInfo {
    std::vector<std::string> names;   // "-o", "--output"
    std::string value;                // "FILE", "X,Y"; empty: takes none
    std::vector<std::string> choices; // words that the value may be
    bool valueOptional = false;       // `--png` or `--png=FILE`
    std::string doc;                  // one line without a full stop
};

struct ArgumentInfo {
    std::string name; // "scene", "image"
    std::string doc;
    std::vector<std::string> choices;
    bool required = false;
    bool repeats = false;
};

struct CommandInfo {
    std::string name;
    std::string group;   // heading in the list of commands
    std::string summary; // one sentence
    std::string more;    // examples and remarks, several lines; may be empty
    std::vector<ArgumentInfo> arguments;
    std::vector<FlagInfo> flags;
    std::vector<CommandInfo> actions; // `info`, `make` and `convert` of `volume`; of the root: all commands
};

// The list of all commands, for `abbe help`.
std::string commandListText(const CommandInfo& root);

// "abbe render": the command, or action of one, that these words name; null if there is none.
const CommandInfo* findCommand(const CommandInfo& root, const std::vector<std::string>& words);

// In the man macros of troff, UTF-8: `abbe`, then `abbe-render` and the others. `version` is that of the program:
// "0.1.0".
struct ManPage {
    std::string name, text;
};
std::vector<ManPage> manPages(const CommandInfo& root, const std::string& version);

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

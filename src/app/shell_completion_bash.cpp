#include "app/shell_completion.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

namespace {

// Runs in any bash from 4 on, with or without the package bash-completion.
constexpr std::string_view kBashHead = R"(# Completion of abbe for bash, made by `abbe reference bash`.
_abbe_files() { # WORD ENDING: folders, and files whose names end so
    local IFS=$'\n'
    compopt -o filenames 2>/dev/null
    COMPREPLY+=($(compgen -d -- "$1") $(compgen -f -X "!*$2" -- "$1"))
}
_abbe() {
    local word=$2 before=$3 command=${COMP_WORDS[1]} flags= words= ending= value=
    COMPREPLY=()
    # The shell takes `--png=a.png` for three words.
    [[ $word == = ]] && word=
    [[ $before == = ]] && before=${COMP_WORDS[COMP_CWORD - 2]}
    [[ $COMP_CWORD -eq 1 ]] && command=
)";

constexpr std::string_view kBashTail = R"(    if [[ $value == file ]]; then
        _abbe_files "$word" ""
    elif [[ -n $value ]]; then
        [[ $value == any ]] || COMPREPLY=($(compgen -W "$value" -- "$word"))
    elif [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$flags" -- "$word"))
    else
        [[ -n $words ]] && COMPREPLY=($(compgen -W "$words" -- "$word"))
        [[ $ending == none ]] || _abbe_files "$word" "$ending"
    fi
}
complete -F _abbe abbe
)";

std::string valueCase(const FlagInfo& flag) {
    const Expected expected = expectedOf(flag);
    if (expected == Expected::nothing) return {};
    const std::string value = expected == Expected::file   ? "file"
                              : expected == Expected::word ? fmt::format("{}", fmt::join(flag.choices, " "))
                                                           : "any";
    return fmt::format("        {}) value={} ;;\n", fmt::join(flag.names, " | "), singleQuoted(value));
}

std::string commandCase(const CommandInfo& command, const std::string& pattern, bool topics) {
    std::vector<std::string> flags, words;
    std::string values, ending = "none";
    for (const FlagInfo& flag : command.flags) {
        flags.insert(flags.end(), flag.names.begin(), flag.names.end());
        values += valueCase(flag);
    }
    for (const ArgumentInfo& argument : command.arguments) {
        words.insert(words.end(), argument.choices.begin(), argument.choices.end());
        if (expectedAt(argument) == Expected::file) ending = fileEnding(argument);
        if (expectedAt(argument) == Expected::topic && topics) ending = ".scene";
    }
    std::string text =
        fmt::format("    {})\n        flags={}\n", pattern, singleQuoted(fmt::format("{}", fmt::join(flags, " "))));
    if (ending != "none" || !words.empty() || command.arguments.empty())
        text += fmt::format("        ending={}\n", singleQuoted(ending));
    if (!words.empty())
        text += fmt::format("        words={}\n", singleQuoted(fmt::format("{}", fmt::join(words, " "))));
    if (topics) text += "        words=$_abbe_topics\n";
    if (!values.empty()) text += "        case $before in\n" + values + "        esac\n";
    return text + "        ;;\n";
}

std::string bashNames(const CommandInfo& command) {
    std::vector<std::string> names;
    for (const CommandInfo& action : command.actions) names.push_back(action.name);
    return fmt::format("{}", fmt::join(names, " "));
}

} // namespace

std::string bashCompletion(const CommandInfo& root, const std::vector<std::string>& topics) {
    const std::string commands = bashNames(root);
    std::string text(kBashHead);
    std::string cases, below;
    for (const CommandInfo& command : root.actions) {
        if (!command.actions.empty()) {
            below += fmt::format(
                "    [[ $command == {0} && $COMP_CWORD -gt 2 ]] && command=\"{0} ${{COMP_WORDS[2]}}\"\n", command.name);
            cases += fmt::format("    {}) words='{}' ending=none flags=--help ;;\n", command.name, bashNames(command));
            for (const CommandInfo& action : command.actions)
                cases += commandCase(action, fmt::format("'{} {}'", command.name, action.name), false);
        } else if (command.name != "render") {
            const bool hasTopics = command.name == "explain" || command.name == "help";
            cases += commandCase(command, command.name, hasTopics);
        }
    }
    text += below + "    case $command in\n";
    text += fmt::format("    '') words='{}' ending=.scene flags='--help --version' ;;\n", commands) + cases;
    text += commandCase(*findCommand(root, {"render"}), "*", false); // also of a scene without a command
    text += "    esac\n" + std::string(kBashTail);
    std::vector<std::string> words = topics;
    for (const CommandInfo& command : root.actions)
        if (!std::ranges::binary_search(topics, command.name)) words.push_back(command.name);
    return text + fmt::format("_abbe_topics='{}'\n", fmt::join(words, " "));
}

} // namespace abbe

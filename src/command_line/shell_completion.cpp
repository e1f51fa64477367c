#include "command_line/command_tree.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

Expected expectedAt(const ArgumentInfo& argument) {
    if (!argument.choices.empty()) return Expected::word;
    return argument.name == "topic" ? Expected::topic : Expected::file;
}

Expected expectedOf(const FlagInfo& flag) {
    if (flag.value.empty()) return Expected::nothing;
    if (!flag.choices.empty() && flag.value.find("FILE") == std::string::npos) return Expected::word;
    return flag.value.starts_with("FILE") || flag.value == "DIR" ? Expected::file : Expected::anything;
}

std::string fileEnding(const ArgumentInfo& argument) {
    if (argument.name == "scene" || argument.name == "scenes") return ".scene";
    if (argument.name == "image") return ".exr";
    return argument.name == "parts" ? ".abbe" : "";
}

std::string singleQuoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'') out += "'\\'";
        out += c;
    }
    return out + "'";
}

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

namespace {

// Brackets end a description, colons a field.
std::string zshText(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
        out += c;
    }
    return out;
}

std::string zshFiles(const std::string& ending) {
    return ending.empty() ? "_files" : fmt::format("_files -g \"*{}\"", ending);
}

std::string zshAction(const FlagInfo& flag) {
    const Expected expected = expectedOf(flag);
    if (expected == Expected::nothing) return {};
    const std::string words = expected == Expected::word   ? fmt::format("({})", fmt::join(flag.choices, " "))
                              : expected == Expected::file ? "_files"
                                                           : " ";
    return fmt::format("{}:{}:{}", flag.valueOptional ? ":" : "", zshText(flag.value), words);
}

// One line for each name; an equals sign behind a long one says that the value may also be the next word.
std::string zshFlag(const FlagInfo& flag) {
    std::string lines;
    for (const std::string& name : flag.names) {
        const bool longName = name.starts_with("--");
        const std::string_view mark = flag.value.empty() ? "" : flag.valueOptional ? "=-" : longName ? "=" : "+";
        lines +=
            " \\\n        " + singleQuoted(fmt::format("*{}{}[{}]{}", name, mark, zshText(flag.doc), zshAction(flag)));
    }
    return lines;
}

std::string zshArgument(const ArgumentInfo& argument, std::size_t position) {
    const Expected expected = expectedAt(argument);
    const std::string what = expected == Expected::word    ? fmt::format("({})", fmt::join(argument.choices, " "))
                             : expected == Expected::topic ? "_abbe_topic"
                                                           : zshFiles(fileEnding(argument));
    const std::string place = argument.repeats || expected == Expected::topic ? "*" : fmt::format("{}", position);
    return " \\\n        " + singleQuoted(fmt::format("{}:{}:{}", place, zshText(argument.name), what));
}

std::string zshArguments(const CommandInfo& command) {
    std::string text = "    _arguments -s";
    for (const FlagInfo& flag : command.flags) text += zshFlag(flag);
    for (std::size_t i = 0; i < command.arguments.size(); ++i) text += zshArgument(command.arguments[i], i + 1);
    return text + "\n";
}

std::string zshNames(const CommandInfo& command) {
    std::string text = "    names=(";
    for (const CommandInfo& action : command.actions)
        text += "\n        " + singleQuoted(fmt::format("{}:{}", action.name, zshText(action.summary)));
    return text + ")\n";
}

// Goes on with the function of the command or action that is named.
std::string zshChoice(const CommandInfo& command, const std::string& name) {
    std::string text = fmt::format("{}() {{\n    local -a names\n", name) + zshNames(command);
    text += "    if ((CURRENT == 2)); then\n        _describe -t commands command names\n";
    if (name == "_abbe") text += "        _files -g '*.scene'\n";
    text +=
        fmt::format("        return\n    fi\n    local action=$words[2]\n    if ((${{+functions[{}_$action]}})); then\n"
                    "        shift words\n        ((CURRENT--))\n        {}_$action\n",
                    name, name);
    if (name == "_abbe") text += "    else\n        _abbe_render\n"; // a scene without a command
    return text + "    fi\n}\n";
}

} // namespace

std::string zshCompletion(const CommandInfo& root, const std::vector<std::string>& topics) {
    std::string text = "#compdef abbe\n# Completion of abbe for zsh, made by `abbe reference zsh`.\n";
    text += fmt::format("_abbe_topic() {{\n    local -a topics\n    topics=({})\n    compadd -a topics\n"
                        "    _files -g '*.scene'\n}}\n",
                        fmt::join(topics, " "));
    for (const CommandInfo& command : root.actions) {
        const std::string name = "_abbe_" + command.name;
        if (command.actions.empty()) text += fmt::format("{}() {{\n{}}}\n", name, zshArguments(command));
        for (const CommandInfo& action : command.actions)
            text += fmt::format("{}_{}() {{\n{}}}\n", name, action.name, zshArguments(action));
        if (!command.actions.empty()) text += zshChoice(command, name);
    }
    text += zshChoice(root, "_abbe");
    // Found on $fpath the file is the function itself; sourced, it has to be registered.
    return text + "if [[ $funcstack[1] == _abbe ]]; then\n    _abbe \"$@\"\nelse\n    compdef _abbe abbe\nfi\n";
}

namespace {

std::string fishQuoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'' || c == '\\') out += '\\';
        out += c;
    }
    return out + "'";
}

std::string fishFiles(const std::string& ending) {
    return ending.empty() ? "-F" : fmt::format("-k -a '(__fish_complete_suffix {})'", ending);
}

std::string fishLine(const std::string& condition, const std::string& what) {
    return fmt::format("complete -c abbe -n {} {}\n", fishQuoted(condition), what);
}

std::string fishFlag(const FlagInfo& flag, const std::string& condition) {
    std::string what;
    for (const std::string& name : flag.names)
        what += name.starts_with("--") ? fmt::format("-l {} ", name.substr(2)) : fmt::format("-s {} ", name.substr(1));
    switch (flag.valueOptional ? Expected::nothing : expectedOf(flag)) {
    case Expected::word:
        what += fmt::format("-x -a {} ", fishQuoted(fmt::format("{}", fmt::join(flag.choices, " "))));
        break;
    case Expected::file:
        what += "-r -F ";
        break;
    case Expected::nothing:
        break;
    default:
        what += "-x ";
    }
    return fishLine(condition, what + "-d " + fishQuoted(flag.doc));
}

std::string fishCommand(const CommandInfo& command, const std::string& condition) {
    std::string text;
    for (const FlagInfo& flag : command.flags) text += fishFlag(flag, condition);
    for (const ArgumentInfo& argument : command.arguments) {
        const Expected expected = expectedAt(argument);
        if (expected == Expected::word)
            text += fishLine(condition, "-a " + fishQuoted(fmt::format("{}", fmt::join(argument.choices, " "))));
        if (expected == Expected::topic) text += fishLine(condition, "-a \"$__abbe_topics\"");
        text += fishLine(condition, fishFiles(expected == Expected::topic ? ".scene" : fileEnding(argument)));
    }
    return text;
}

// " render merge …"
std::string fishNames(const CommandInfo& command) {
    std::string names;
    for (const CommandInfo& action : command.actions) names += " " + action.name;
    return names;
}

std::string fishActions(const CommandInfo& command, const std::string& seen) {
    const std::string names = fishNames(command);
    std::string text;
    for (const CommandInfo& action : command.actions) {
        text += fishLine(fmt::format("{}; and not __fish_seen_subcommand_from{}", seen, names),
                         fmt::format("-a {} -d {}", action.name, fishQuoted(action.summary)));
        text += fishCommand(action, fmt::format("{}; and __fish_seen_subcommand_from {}", seen, action.name));
    }
    return text;
}

} // namespace

std::string fishCompletion(const CommandInfo& root, const std::vector<std::string>& topics) {
    std::string text = "# Completion of abbe for fish, made by `abbe reference fish`.\n";
    text += fmt::format("set -g __abbe_topics {}\ncomplete -c abbe -f\n", fmt::join(topics, " "));
    text += fishLine("__fish_use_subcommand", fishFiles(".scene"));
    text += fishLine("__fish_use_subcommand", "-l version -s V -d 'Print the version and what it was built with'");
    for (const CommandInfo& command : root.actions) {
        text +=
            fishLine("__fish_use_subcommand", fmt::format("-a {} -d {}", command.name, fishQuoted(command.summary)));
        std::string seen = "__fish_seen_subcommand_from " + command.name;
        if (command.name == "render") seen += "; or not __fish_seen_subcommand_from" + fishNames(root); // a scene alone
        // `volume convert` is not `convert`.
        for (const CommandInfo& other : root.actions)
            if (findCommand(other, {command.name})) seen += "; and not __fish_seen_subcommand_from " + other.name;
        text += command.actions.empty() ? fishCommand(command, seen) : fishActions(command, seen);
    }
    return text;
}

} // namespace abbe

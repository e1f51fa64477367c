#include "app/shell_completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

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

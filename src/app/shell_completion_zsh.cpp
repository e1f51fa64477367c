#include "app/shell_completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

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

} // namespace abbe

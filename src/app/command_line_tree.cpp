#include "app/command_line_tree.h"

#include "schema/scene_tree.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// `a|b|c` lists words; capitals (`TIME|off|keep`) stand for something.
std::vector<std::string> choicesOf(const std::string& type) {
    std::vector<std::string> words;
    if (type.find('|') == std::string::npos) return words;
    for (std::size_t begin = 0; begin <= type.size();) {
        const std::size_t end = std::min(type.find('|', begin), type.size());
        const std::string word = type.substr(begin, end - begin);
        if (std::ranges::none_of(word, [](unsigned char c) { return std::isupper(c); })) words.push_back(word);
        begin = end + 1;
    }
    return words;
}

FlagInfo flagOf(const CLI::Option& option) {
    FlagInfo flag;
    for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
    flag.doc = option.get_description();
    flag.valueOptional = option.get_name(false, true).find('{') != std::string::npos; // `--png{.}`
    const bool takesValue = option.get_items_expected_max() > 0;
    if (takesValue) flag.value = option.get_type_name();
    if (flag.valueOptional) flag.value = "FILE";
    flag.choices = choicesOf(flag.value);
    return flag;
}

ArgumentInfo argumentOf(const CLI::Option& option) {
    return {option.get_name(true), option.get_description(), choicesOf(option.get_type_name()), option.get_required(),
            option.get_items_expected_max() > 1};
}

// The flag that an unknown one probably means.
std::string flagSuggestion(const CLI::App& command, const std::string& flag) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    const std::vector<std::string_view> candidates(names.begin(), names.end());
    return std::string(schema::nearest(flag, candidates));
}

} // namespace

CommandInfo describeCommands(const CLI::App& command) {
    CommandInfo info;
    info.name = command.get_name();
    info.group = command.get_group();
    const std::string text = command.get_description();
    const std::size_t end = std::min(text.find('\n'), text.size());
    info.summary = text.substr(0, end);
    info.more = text.substr(std::min(text.find_first_not_of('\n', end), text.size()));
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_positional())
            info.arguments.push_back(argumentOf(*option));
        else
            info.flags.push_back(flagOf(*option));
    }
    for (const CLI::App* below : command.get_subcommands({})) info.actions.push_back(describeCommands(*below));
    return info;
}

const CLI::App& chosenCommand(const CLI::App& root) {
    const CLI::App* command = &root;
    for (auto below = command->get_subcommands(); !below.empty(); below = command->get_subcommands())
        command = below.front();
    return *command;
}

std::string fullName(const CLI::App& command) {
    const CLI::App* above = command.get_parent();
    return above ? fullName(*above) + " " + command.get_name() : command.get_name();
}

std::string helpText(const CLI::App& command) {
    const CLI::App* above = command.get_parent();
    std::string text = above ? command.help(fullName(*above)) : command.help();
    constexpr std::string_view kInternal = "--png{.}      "; // how the library writes an optional value
    if (const auto at = text.find(kInternal); at != std::string::npos)
        text.replace(at, kInternal.size(), "--png[=FILE]  ");
    return text;
}

std::string errorText(const CLI::App& root, const CLI::ParseError& error) {
    const CLI::App& command = chosenCommand(root);
    const std::string where = fullName(command);
    const std::vector<std::string> extra = command.remaining();
    for (const std::string& word : extra) {
        if (word.size() < 2 || word[0] != '-') continue;
        const std::string flag = word.substr(0, word.find('='));
        const std::string near = flagSuggestion(command, flag);
        return fmt::format("abbe: unknown flag `{}`{}\n  `{} --help` lists the flags\n", flag,
                           near.empty() ? "" : fmt::format("; did you mean `{}`?", near), where);
    }
    const std::string message =
        extra.empty() ? std::string(error.what()) : fmt::format("unexpected argument `{}`", extra.front());
    return fmt::format("abbe: {}\n  `{} --help` shows how it is used\n", message, where);
}

} // namespace abbe

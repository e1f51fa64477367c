// Pages for `man`: abbe(1), and abbe-render(1) for each command.
#include "app/program_end.h"
#include "command_line/command_tree.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace abbe {

namespace {

// Hyphens stay what they are on a command line, and no line is taken for a request.
std::string troff(std::string_view text) {
    std::string out;
    bool lineStart = true;
    for (const char c : text) {
        if (lineStart && (c == '.' || c == '\'')) out += "\\&";
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c;
        lineStart = c == '\n';
    }
    return out;
}

std::string flagTitle(const FlagInfo& flag) {
    std::string text;
    for (const std::string& name : flag.names)
        text += fmt::format("{}\\fB{}\\fR", text.empty() ? "" : ", ", troff(name));
    if (flag.value.empty()) return text;
    const std::string value = fmt::format("\\fI{}\\fR", troff(flag.value));
    return flag.valueOptional ? fmt::format("{}[={}]", text, value) : text + " " + value;
}

std::string synopsis(const CommandInfo& command, const std::string& name) {
    std::string text = fmt::format("\\fB{}\\fR [\\fIFLAG\\fR…]", troff(name));
    for (const ArgumentInfo& argument : command.arguments) {
        const std::string word = fmt::format("\\fI{}\\fR{}", troff(argument.name), argument.repeats ? "…" : "");
        text += argument.required ? " " + word : " [" + word + "]";
    }
    return text;
}

std::string title(std::string_view page, const std::string& version) {
    std::string name(page);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return fmt::format(".\\\" Made by `abbe reference man`.\n.TH {} 1 \"\" \"abbe {}\"\n", troff(name), version);
}

// What a command, or an action of one, takes.
std::string flagsText(const CommandInfo& command) {
    std::string text;
    for (const ArgumentInfo& argument : command.arguments)
        text += fmt::format(".TP\n\\fI{}\\fR\n{}\n", troff(argument.name), troff(argument.doc));
    for (const FlagInfo& flag : command.flags) text += fmt::format(".TP\n{}\n{}\n", flagTitle(flag), troff(flag.doc));
    return text;
}

std::string asItIs(const std::string& lines) {
    return lines.empty() ? std::string() : fmt::format(".PP\n.nf\n{}\n.fi\n", troff(lines));
}

std::string exitStatus() {
    std::string text = ".SH EXIT STATUS\n";
    for (const ExitCodeText& exit : kExitCodes)
        text += fmt::format(".TP\n{}\n{}\n", static_cast<int>(exit.code), troff(exit.meaning));
    return text;
}

struct Variable {
    const char *name, *meaning;
};
constexpr Variable kVariables[] = {
    {"ABBE_PATH", "Folders with `:` between them in which scenes may read, and in which names of files are looked up."},
    {"ABBE_USD", "The program that reads stages of OpenUSD, `abbe-usd` of the Python package."},
    {"OCIO", "The OpenColorIO configuration for pictures on a display; without it the built-in one."},
    {"NO_COLOR", "No colours in messages."},
    {"XDG_CACHE_HOME", "Where `abbe/`, the cache of textures and packs, is made; without it ~/.cache."},
};

std::string overview(const CommandInfo& root, const std::string& version) {
    std::string text = title(root.name, version);
    text += ".SH NAME\nabbe \\- spectral, physically based film renderer\n";
    text += ".SH SYNOPSIS\n.B abbe\n\\fICOMMAND\\fR [\\fIFLAG\\fR…] [\\fIFILE\\fR…]\n.br\n.B abbe\n\\fISCENE\\fR "
            "[\\fIFLAG\\fR…]\n";
    text += fmt::format(".SH DESCRIPTION\n{}\nA scene alone is rendered: \\fBabbe room.scene\\fR is \\fBabbe render "
                        "room.scene\\fR.\nData goes to standard output, everything else to standard error.\n{}",
                        troff(root.summary), asItIs(root.more));
    text += ".SH COMMANDS\nEach has a page of its own.\n";
    for (const CommandInfo& command : root.actions)
        text += fmt::format(".TP\n\\fBabbe\\-{}\\fR(1)\n{}\n", troff(command.name), troff(command.summary));
    text += exitStatus() + ".SH ENVIRONMENT\n";
    for (const Variable& variable : kVariables)
        text += fmt::format(".TP\n.B {}\n{}\n", variable.name, troff(variable.meaning));
    return text + ".SH SEE ALSO\n\\fBabbe explain\\fR prints what the words of the scene language mean.\n";
}

std::string commandPage(const CommandInfo& root, const CommandInfo& command, const std::string& version) {
    const std::string name = root.name + " " + command.name;
    std::string text = title(root.name + "-" + command.name, version);
    text += fmt::format(".SH NAME\n{}\\-{} \\- {}\n.SH SYNOPSIS\n", root.name, troff(command.name),
                        troff(std::string_view(command.summary).substr(0, command.summary.find_last_not_of('.') + 1)));
    if (command.actions.empty()) {
        text += synopsis(command, name) + "\n.SH DESCRIPTION\n" + troff(command.summary) + "\n" + asItIs(command.more);
        text += ".SH ARGUMENTS AND FLAGS\n" + flagsText(command);
    } else {
        for (const CommandInfo& action : command.actions)
            text += (&action == &command.actions[0] ? "" : ".br\n") + synopsis(action, name + " " + action.name) + "\n";
        text += ".SH DESCRIPTION\n" + troff(command.summary) + "\n" + asItIs(command.more) + ".SH ACTIONS\n";
        for (const CommandInfo& action : command.actions)
            text += fmt::format(".SS {}\n{}\n{}{}", troff(name + " " + action.name), troff(action.summary),
                                asItIs(action.more), flagsText(action));
    }
    return text + exitStatus() + ".SH SEE ALSO\n\\fBabbe\\fR(1)\n";
}

} // namespace

std::vector<ManPage> manPages(const CommandInfo& root, const std::string& version) {
    std::vector<ManPage> pages{{root.name, overview(root, version)}};
    for (const CommandInfo& command : root.actions)
        pages.push_back({root.name + "-" + command.name, commandPage(root, command, version)});
    return pages;
}

} // namespace abbe

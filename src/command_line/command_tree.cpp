#include "command_line/command_tree.h"

#include "app/program_end.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

std::string commandListText(const CommandInfo& root) {
    std::string text = fmt::format("{}\n\n{}\n", root.summary, root.more);
    std::string group;
    for (const CommandInfo& command : root.actions) {
        if (command.group != group) text += fmt::format("\n{}:\n", group = command.group);
        text += fmt::format("  {:<11} {}\n", command.name, command.summary);
    }
    text += "\n`abbe help render` explains a command and lists its flags, `abbe explain` the scene language.\n"
            "`abbe --version` prints the version.\n\nExit codes:\n";
    for (const ExitCodeText& exit : kExitCodes)
        text += fmt::format("  {:<4} {}\n", static_cast<int>(exit.code), exit.meaning);
    return text;
}

const CommandInfo* findCommand(const CommandInfo& root, const std::vector<std::string>& words) {
    const CommandInfo* command = &root;
    for (const std::string& word : words) {
        const auto found = std::ranges::find(command->actions, word, &CommandInfo::name);
        if (found == command->actions.end()) return nullptr;
        command = &*found;
    }
    return command;
}

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

std::string commandSection(const CommandInfo& command, const std::string& above) {
    const std::string name = above + " " + command.name;
    if (!command.actions.empty()) {
        std::string text;
        for (const CommandInfo& action : command.actions) text += commandSection(action, name);
        return text;
    }
    std::string text =
        fmt::format(".SS {}\n{}\n.PP\n{}\n", troff(name), synopsis(command, name), troff(command.summary));
    for (const ArgumentInfo& argument : command.arguments)
        text += fmt::format(".TP\n\\fI{}\\fR\n{}\n", troff(argument.name), troff(argument.doc));
    for (const FlagInfo& flag : command.flags) text += fmt::format(".TP\n{}\n{}\n", flagTitle(flag), troff(flag.doc));
    if (!command.more.empty()) text += fmt::format(".PP\n.nf\n{}\n.fi\n", troff(command.more));
    return text;
}

} // namespace

std::string manPage(const CommandInfo& root, const std::string& version) {
    std::string text = fmt::format(".\\\" Made by `abbe reference man`.\n.TH ABBE 1 \"\" \"abbe {}\"\n", version);
    text += ".SH NAME\nabbe \\- spectral, physically based film renderer\n";
    text += ".SH SYNOPSIS\n.B abbe\n\\fICOMMAND\\fR [\\fIFLAG\\fR…] [\\fIFILE\\fR…]\n.br\n.B abbe\n\\fISCENE\\fR "
            "[\\fIFLAG\\fR…]\n";
    text += fmt::format(
        ".SH DESCRIPTION\n{}\nA scene alone is rendered: \\fBabbe room.scene\\fR is \\fBabbe render "
        "room.scene\\fR.\nData goes to standard output, everything else to standard error.\n.PP\n.nf\n{}\n.fi\n",
        troff(root.summary), troff(root.more));
    text += ".SH COMMANDS\n";
    for (const CommandInfo& command : root.actions) text += commandSection(command, root.name);
    text += ".SH EXIT STATUS\n";
    for (const ExitCodeText& exit : kExitCodes)
        text += fmt::format(".TP\n{}\n{}\n", static_cast<int>(exit.code), troff(exit.meaning));
    text += ".SH ENVIRONMENT\n.TP\n.B OCIO\nThe OpenColorIO configuration for pictures on a display; without it the "
            "built\\-in one.\n.TP\n.B NO_COLOR\nNo colours in messages.\n";
    text += ".SH SEE ALSO\n\\fBabbe explain\\fR prints what the words of the scene language mean.\n";
    return text;
}

} // namespace abbe

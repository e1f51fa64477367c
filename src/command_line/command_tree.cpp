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

} // namespace abbe

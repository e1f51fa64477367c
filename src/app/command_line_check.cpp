#include "app/command_line_check.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace abbe {

namespace {

void refuseContradictions(const CheckOptions& options) {
    const auto standard = std::ranges::count(options.paths, "-");
    if (standard > 1) throw CLI::ValidationError("scenes", "standard input can be read once");
    if (standard > 0 && options.fix) throw CLI::ValidationError("--fix", "standard input cannot be repaired in place");
    if (standard == 0 && !options.standsFor.empty())
        throw CLI::ValidationError("--as", "it is for standard input, `abbe check -`");
}

} // namespace

const char* const kCheckHelp = R"(Finds everything that is wrong with scenes, without rendering.

Examples:
  abbe check room.scene
  abbe check --fix room.scene                  repairs what can be repaired safely
  abbe check -q - --as room.scene <room.scene  from an editor: the text comes from standard input
  abbe check --strict --format=short *.scene   for editors and CI)";

void addCheckArguments(CLI::App& command, CheckOptions& options, std::string& format) {
    command.add_option("scenes", options.paths, "Scene files; - is standard input")->required()->type_name("");
    command
        .add_option("--as", options.standsFor, "What standard input stands for: its name, and the folder of its files")
        ->type_name("FILE");
    command.add_flag("--fix", options.fix, "Apply the repairs that are certain, in place");
    command.add_flag("--quiet,-q", options.quiet, "Say nothing but warnings and errors");
    command.add_flag("--strict", options.strict, "Exit with 4 when there are warnings");
    command.add_flag("--textures", options.textures, "Read image textures to their ends, which also makes them ready");
    command.add_option("--format", format, "How faults are told; short: path:line:column: text")
        ->check(CLI::IsMember({"human", "short", "json"}).description(""))
        ->type_name("human|short|json");
    command.add_flag_callback(
        "--json", [&format] { format = "json"; }, "The same as --format=json");
    command.callback([&options] { refuseContradictions(options); });
}

} // namespace abbe

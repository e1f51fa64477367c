#include "app/command_line_convert.h"

#include <CLI/CLI.hpp>

namespace abbe {

const char* const kConvertHelp = R"(Turns an EXR into a PNG through a display view of OpenColorIO.

Examples:
  abbe convert room.exr room.png
  abbe convert room.exr room.png --exposure 1.5 --view Raw
  abbe convert room.exr depth.png --layer depth
  abbe convert room.deep.exr room.png             deep samples put over each other)";

void addConvertArguments(CLI::App& command, ConvertOptions& options) {
    command.add_option("input", options.input, "EXR that says what its colours are")->required()->type_name("");
    command.add_option("output", options.output, "PNG, by its name too: room.png")->required()->type_name("");
    command.add_option("--layer", options.layer, "A layer, or a channel, instead of the picture: depth, S0.555nm")
        ->type_name("NAME");
    command.add_flag("--overscan", options.overscan, "Show what lies beyond the edges of the picture, too");
    command.add_option("--bits", options.bits, "Bits per component")
        ->check(CLI::IsMember({8, 16}).description(""))
        ->type_name("8|16");
}

} // namespace abbe

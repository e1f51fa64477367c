#include "app/command_line_denoise.h"

#include <CLI/CLI.hpp>

namespace abbe {

const char* const kDenoiseHelp = R"(Adds a denoised layer to an image; the picture itself stays as it is.

Examples:
  abbe denoise room.exr                        adds denoised.R .G .B and denoised.error to the file
  abbe denoise room.exr -o clean.exr           leaves room.exr alone
  abbe denoise room.exr --preview              rough, in a fraction of the time

The scene asks for what it needs: film { layers { denoise } })";

void addDenoiseArguments(CLI::App& command, DenoiseOptions& options, CommonOptions& common) {
    command.add_option("image", options.input, "EXR of a render with `layers { denoise }`")->required()->type_name("");
    command.add_option("-o,--output", options.output, "EXR to write; without it the image itself gets the layer")
        ->type_name("FILE");
    command.add_flag_callback(
        "--preview", [&options] { options.method = DenoiseMethod::preview; }, "Wavelets instead of regressions: fast");
    command.add_option("-t,--threads", common.threads, "Threads; without it one per core")
        ->check(CLI::Range(1, 4096).description(""))
        ->type_name("N");
    command.add_flag("--json", common.json, "JSON on stdout");
}

} // namespace abbe

#include "app/command_line_certify.h"

#include <CLI/CLI.hpp>

namespace abbe {

const char* const kCertifyHelp = R"(Measures an image against long renders and says whether its stated error was right.

Examples:
  abbe certify room.exr                            what the image says about its error
  abbe certify room.exr --ref long.exr             exit code 4 if a measured error is outside its interval
  abbe certify room.exr --ref a.exr --ref b.exr    references of two seeds: their noise cancels)";

void addCertifyArguments(CLI::App& command, CertifyOptions& options, bool& json) {
    command.add_option("image", options.image, "EXR with a certificate")->required()->type_name("");
    command
        .add_option("--ref", options.references,
                    "A long render of the same; a second one of another seed cancels its noise")
        ->allow_extra_args(false)
        ->type_name("FILE");
    command.add_flag("--json", json, "JSON on stdout");
    command.callback([&options] {
        if (options.references.size() > 2)
            throw CLI::ValidationError("--ref", "more than two references have no meaning");
    });
}

} // namespace abbe

// `abbe denoise`: a denoised layer for an image.
#pragma once

#include "command_line/command.h"
#include "denoise/denoise.h"

#include <string>

namespace abbe {

struct DenoiseOptions {
    std::string input, output; // no output: the input gets the layer
    DenoiseMethod method = DenoiseMethod::nfor;
};

extern const char* const kDenoiseHelp;
void addArguments(Arguments&, DenoiseOptions&);
ExitCode run(const DenoiseOptions&, const CommonOptions&);

} // namespace abbe

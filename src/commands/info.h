// `abbe info`: what is in a scene or in an image.
#pragma once

#include "command_line/command.h"

#include <string>
#include <vector>

namespace abbe {

struct InfoOptions {
    std::string path;
    std::vector<std::string> defines;
};

extern const char* const kInfoHelp;
void addArguments(Arguments&, InfoOptions&);
ExitCode run(const InfoOptions&, const CommonOptions&);

} // namespace abbe

// `abbe check`: what is wrong with scenes, without rendering.
#pragma once

#include "command_line/command.h"

#include <string>
#include <vector>

namespace abbe {

struct CheckOptions {
    std::vector<std::string> paths; // "-": standard input
    std::string standsFor;          // the file that standard input is the text of
    std::vector<std::string> defines;
    bool fix = false;
    bool strict = false;
    bool textures = false; // read to their ends
    bool quiet = false;
};

extern const char* const kCheckHelp;
void addArguments(Arguments&, CheckOptions&);
ExitCode run(const CheckOptions&, const CommonOptions&);

} // namespace abbe

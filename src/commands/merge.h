// `abbe merge`: parts of a render, put together to the bits of the whole.
#pragma once

#include "command_line/command.h"
#include "pictures/display_view.h"
#include "pictures/image_output.h"

#include <string>
#include <vector>

namespace abbe {

struct MergeOptions {
    std::vector<std::string> parts;
    std::string scene;  // empty: where it was when the first part was made
    std::string output; // EXR
    PngOptions png;
    ViewOptions view;

    static bool makesFiles() { return true; }
};

extern const char* const kMergeHelp;
void addArguments(Arguments&, MergeOptions&);
ExitCode run(const MergeOptions&, const CommonOptions&);

} // namespace abbe

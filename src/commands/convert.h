// `abbe convert`: a PNG of an image or of one of its layers.
#pragma once

#include "command_line/command.h"
#include "pictures/display_view.h"

#include <string>

namespace abbe {

struct ConvertOptions {
    std::string input, output;
    std::string layer;     // or a channel; empty: the picture
    bool overscan = false; // the whole data window
    ViewOptions view;
    int bits = 8;
};

extern const char* const kConvertHelp;
void addArguments(Arguments&, ConvertOptions&);
ExitCode run(const ConvertOptions&, const CommonOptions&);

} // namespace abbe

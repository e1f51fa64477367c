// `abbe certify`: how wrong an image is, measured against what it says of itself.
#pragma once

#include "command_line/command.h"
#include "pictures/display_view.h"

#include <string>
#include <vector>

namespace abbe {

struct CertifyOptions {
    std::string image;
    std::vector<std::string> references; // none, one, or two of different seeds
    ViewOptions view;
};

extern const char* const kCertifyHelp;
void addArguments(Arguments&, CertifyOptions&);
ExitCode run(const CertifyOptions&, const CommonOptions&);

} // namespace abbe

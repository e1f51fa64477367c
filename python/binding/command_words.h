// A render as the command line would ask for it: what images say of themselves, and what parts are merged by.
#pragma once

#include "render_run/render_options.h"

#include <string>
#include <vector>

namespace abbe::python {

// Words behind the program's name: "render", "room.scene", "--samples", "64", …
std::vector<std::string> commandWords(const RenderOptions&);
std::string commandLine(const std::vector<std::string>& words);

} // namespace abbe::python

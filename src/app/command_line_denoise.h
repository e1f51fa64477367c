// The arguments of `abbe denoise`. CLI11 is known to the sources of the command line alone.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

// What --help of the command begins with.
extern const char* const kDenoiseHelp;

// `options` and `common` must outlive `command`.
void addDenoiseArguments(CLI::App& command, DenoiseOptions& options, CommonOptions& common);

} // namespace abbe

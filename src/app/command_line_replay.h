// The arguments of `abbe replay`. CLI11 is known to the sources of the command line alone.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

// What --help of the command begins with.
extern const char* const kReplayHelp;

// `options` and `common` must outlive `command`.
void addReplayArguments(CLI::App& command, ReplayOptions& options, CommonOptions& common);

} // namespace abbe

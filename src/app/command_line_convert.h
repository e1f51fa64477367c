// The arguments of `abbe convert`. CLI11 is known to the sources of the command line alone.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

// What --help of the command begins with.
extern const char* const kConvertHelp;

// Without those of the view. `options` must outlive `command`.
void addConvertArguments(CLI::App& command, ConvertOptions& options);

} // namespace abbe

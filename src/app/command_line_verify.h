// The arguments of `abbe verify`.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

extern const char* const kVerifyHelp;

// All must outlive `command`.
void addVerifyArguments(CLI::App& command, VerifyOptions& options, CommonOptions& common);

} // namespace abbe

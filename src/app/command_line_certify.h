// The arguments of `abbe certify`. CLI11 is known to the sources of the command line alone.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

// What --help of the command begins with.
extern const char* const kCertifyHelp;

// `options` and `json` must outlive `command`. The options of the view are the caller's.
void addCertifyArguments(CLI::App& command, CertifyOptions& options, bool& json);

} // namespace abbe

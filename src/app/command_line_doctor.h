// The arguments of `abbe doctor`. CLI11 is known to the sources of the command line alone.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

// What --help of the command begins with.
extern const char* const kDoctorHelp;

// `options` and `common` must outlive `command`.
void addDoctorArguments(CLI::App& command, DoctorOptions& options, CommonOptions& common);

} // namespace abbe

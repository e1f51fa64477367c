// `abbe check` on the command line.
#pragma once

#include "app/options.h"

#include <string>

namespace CLI {
class App;
}

namespace abbe {

extern const char* const kCheckHelp;
// `format`: "human", "short" or "json".
void addCheckArguments(CLI::App&, CheckOptions&, std::string& format);

} // namespace abbe

// `abbe reference` on the command line.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

extern const char* const kReferenceHelp;
void addReferenceArguments(CLI::App&, ReferenceOptions&);

} // namespace abbe

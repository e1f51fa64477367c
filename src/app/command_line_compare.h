// The arguments of `abbe compare`. CLI11 is known to the sources of the command line alone.
#pragma once

#include "app/options.h"

#include <string>
#include <variant>

namespace CLI {
class App;
}

namespace abbe {

// What --help of the command begins with.
extern const char* const kCompareHelp;

// `options` and `json` must outlive `command`.
void addCompareArguments(CLI::App& command, CompareOptions& options, bool& json);

// "relmse=0.01", or a number alone for relMSE; else what is wrong with it.
std::variant<CompareThreshold, std::string> readThreshold(const std::string& text);

} // namespace abbe

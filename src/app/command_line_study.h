// The arguments of `abbe study`.
#pragma once

#include "app/options.h"

namespace CLI {
class App;
}

namespace abbe {

extern const char* const kStudyHelp;

// All must outlive `command`.
void addStudyArguments(CLI::App& command, StudyOptions& options, CommonOptions& common);

} // namespace abbe

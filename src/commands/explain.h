// `abbe explain`: a scene, a word of the language, or a diagnostic.
#pragma once

#include "command_line/command.h"
#include "scene/build.h"

#include <string>
#include <vector>

namespace abbe {

struct ExplainOptions {
    std::string topic;    // a scene file, or words of the language; empty: the language itself
    bool effects = false; // of the scene; without a topic: those that there are
    BuildOptions build;   // camera, size, seed and pilot of the render that is explained
    std::vector<std::string> defines;
};

extern const char* const kExplainHelp;
void addArguments(Arguments&, ExplainOptions&);
ExitCode run(const ExplainOptions&, const CommonOptions&);

} // namespace abbe

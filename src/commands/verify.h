// `abbe verify`: two independent estimators of one scene, and whether they agree.
#pragma once

#include "app/load.h"
#include "command_line/command.h"
#include "scene/build.h"

#include <cstdint>
#include <optional>

namespace abbe {

struct VerifyOptions {
    SceneInput input;
    BuildOptions build;                  // camera and size; without a size at most kVerifySide pixels
    double resolution = 0.001;           // relative standard error of the difference
    double timeLimit = 300;              // s
    std::optional<std::int64_t> samples; // per pixel of either, in place of the two
    double level = 0.001;                // of the test
    bool strict = false;
    bool quiet = false;
};

extern const char* const kVerifyHelp;
void addArguments(Arguments&, VerifyOptions&);
ExitCode run(const VerifyOptions&, const CommonOptions&);

} // namespace abbe

// `abbe study`: what accuracy costs in time on a scene.
#pragma once

#include "app/load.h"
#include "command_line/command.h"
#include "scene/build.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

struct StudyOptions {
    SceneInput input;
    std::string output;                  // DIR/NAME of NAME.html, .csv, .json; empty: the scene's name with "-study"
    BuildOptions build;                  // camera and size; without a size at most kStudySide pixels
    std::optional<std::int64_t> samples; // of the last rung; without it kStudySamples, or what the time allows
    int seeds = 8;
    std::optional<double> timeLimit; // s, of the whole study
    std::vector<std::string> variants;
    bool effects = false;                           // these are measured, in place of curves
    bool listVariants = false;                      // print them, and that is all
    std::vector<double> errors{0.01, 0.003, 0.001}; // relative, to tell the time to
    bool resume = false;
    bool quiet = false;

    static bool makesFiles() { return true; }
};

extern const char* const kStudyHelp;
void addArguments(Arguments&, StudyOptions&);
ExitCode run(const StudyOptions&, const CommonOptions&);

} // namespace abbe

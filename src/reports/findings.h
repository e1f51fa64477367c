// What measurements of a scene found: the files that a study writes (JSON, CSV and the page that shows the JSON), and
// what `abbe verify` says, in words and as JSON.
#pragma once

#include "render/scene.h"
#include "study/study_report.h"
#include "verify/verify_run.h"

#include <string>
#include <vector>

namespace abbe {

// What the report does not know by itself.
struct StudyFacts {
    std::string command;       // as typed
    std::string scene, name;   // path; without folder and extension
    int width = 0, height = 0; // pixels
    std::string effects;       // "absorption+dispersion"
    int threads = 0;
    int seeds = 0; // that were asked for
    std::uint64_t seed = 0;
    std::vector<double> errors; // relative, to tell the time to
    bool complete = true;       // false: the time ran out
    std::vector<LeftOutVariant> leftOut;
};

// "abbe-study/1": docs/study.md describes it.
std::string studyJson(const StudyReport&, const StudyFacts&);
// A line for each variant, rung and seed; lines that begin with # say what they are.
std::string studyCsv(const StudyReport&, const StudyFacts&);
// For the terminal: what it all comes to, a line for each curve.
std::string studyTable(const StudyReport&, const StudyFacts&);

struct VerifyFacts {
    std::string path;             // of the scene file
    const Scene* scene = nullptr; // names of what lies where the two differ
    Vec2i size;                   // of the pictures
};

// "0.12 %".
std::string verifyPercent(double part);
// Lines for people, the verdict last.
std::string verifyText(const VerifyReport&, const VerifyFacts&);
// One line: an object with `verdict` "agree", "differ" or "undecided".
std::string verifyJson(const VerifyReport&, const VerifyFacts&);

} // namespace abbe

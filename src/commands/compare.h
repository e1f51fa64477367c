// `abbe compare`: how much images differ.
#pragma once

#include "command_line/command.h"
#include "io/flip.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace abbe {

// A bound on a figure of a comparison; exceeding it is exit code 4.
struct CompareThreshold {
    std::string figure; // a name that findCompareFigure knows
    double value = 0;
};
// "relmse=0.01", or a number alone for relMSE; else what is wrong with it.
std::variant<CompareThreshold, std::string> readThreshold(const std::string& text);

struct CompareOptions {
    std::string image;
    std::optional<std::string> other;    // there, or a reference is
    std::vector<std::string> references; // none: `other` is the reference
    std::vector<CompareThreshold> thresholds;
    std::optional<std::string> html;
    double pixelsPerDegree = kFlipPixelsPerDegree;
};

extern const char* const kCompareHelp;
void addArguments(Arguments&, CompareOptions&);
ExitCode run(const CompareOptions&, const CommonOptions&);

} // namespace abbe

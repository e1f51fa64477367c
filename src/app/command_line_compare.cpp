#include "app/command_line_compare.h"

#include "app/compare_figures.h"
#include "schema/scene_tree.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

void readThresholds(const std::vector<std::string>& texts, CompareOptions& options) {
    options.thresholds.clear();
    for (const std::string& text : texts) {
        auto threshold = readThreshold(text);
        if (const auto* problem = std::get_if<std::string>(&threshold))
            throw CLI::ValidationError("--threshold", *problem);
        options.thresholds.push_back(std::get<CompareThreshold>(threshold));
    }
}

std::string unknownFigure(const std::string& name) {
    std::vector<std::string_view> names;
    for (const CompareFigure& figure : compareFigures()) names.emplace_back(figure.name);
    const std::string_view near = schema::nearest(name, names);
    return fmt::format("no figure is named `{}`{}; there are {}", name,
                       near.empty() ? "" : fmt::format(" (did you mean `{}`?)", near), fmt::join(names, ", "));
}

} // namespace

const char* const kCompareHelp =
    R"(Measures how much images differ: relMSE, PSNR, HDR-FLIP, ΔE2000, a test by variances.

Examples:
  abbe compare room.exr reference.exr
  abbe compare new.exr old.exr --ref truth.exr           which of the two is nearer to the third
  abbe compare room.exr --ref r1.exr --ref r2.exr        references of two seeds: their noise cancels
  abbe compare room.exr ref.exr --html page.html         to look at: wipe, flip, exposure, pixel values
  abbe compare a.exr b.exr --threshold relmse=0.01 --threshold flip=0.05
  abbe compare a.exr b.exr --threshold 0                 fails unless all pixels are equal)";

void addCompareArguments(CLI::App& command, CompareOptions& options, bool& json) {
    command.add_option("image", options.image, "EXR or .hdr")->required()->type_name("");
    command.add_option("other", options.other, "Image to compare with; with --ref its rival")->type_name("");
    command
        .add_option("--ref", options.references, "Compare with this; a second one of another seed cancels its noise")
        ->allow_extra_args(false)
        ->type_name("FILE");
    command
        .add_option_function<std::vector<std::string>>(
            "--threshold", [&options](const auto& texts) { readThresholds(texts, options); },
            "Exit with 4 beyond this bound: flip=0.05; a number alone is for relmse; may be repeated")
        ->allow_extra_args(false)
        ->type_name("FIGURE=X");
    command.add_option("--html", options.html, "Write a page to look at the images")->type_name("FILE");
    command.add_option("--ppd", options.pixelsPerDegree, "Pixels per degree of the observer for FLIP; 67 when absent")
        ->check(CLI::Range(1.0, 1000.0).description(""))
        ->type_name("N");
    command.add_flag("--json", json, "JSON on stdout");
    command.callback([&options] {
        if (!options.other && options.references.empty())
            throw CLI::ValidationError("compare", "an image to compare with is missing");
        if (options.references.size() > 2)
            throw CLI::ValidationError("--ref", "more than two references have no meaning");
    });
}

std::variant<CompareThreshold, std::string> readThreshold(const std::string& text) {
    const std::size_t equals = text.find('=');
    CompareThreshold threshold{equals == std::string::npos ? "relmse" : text.substr(0, equals), 0};
    const char* begin = text.data() + (equals == std::string::npos ? 0 : equals + 1);
    const char* last = text.data() + text.size();
    const auto [end, error] = std::from_chars(begin, last, threshold.value);
    if (!findCompareFigure(threshold.figure)) return unknownFigure(threshold.figure);
    if (error != std::errc() || end != last || !std::isfinite(threshold.value) || threshold.value < 0)
        return fmt::format("`{}` is not a bound such as 0.01 or flip=0.05", text);
    return threshold;
}

} // namespace abbe

#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "pages/pages.h"
#include "pictures/compare_figures.h"
#include "schema/scene_tree.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

const char* const kCompareHelp =
    R"(Measures how much images differ: relMSE, PSNR, HDR-FLIP, ΔE2000, a test by variances.

Examples:
  abbe compare room.exr reference.exr
  abbe compare new.exr old.exr --ref truth.exr           which of the two is nearer to the third
  abbe compare room.exr --ref r1.exr --ref r2.exr        references of two seeds: their noise cancels
  abbe compare room.exr ref.exr --html page.html         to look at: wipe, flip, exposure, pixel values
  abbe compare a.exr b.exr --threshold relmse=0.01 --threshold flip=0.05
  abbe compare a.exr b.exr --threshold 0                 fails unless all pixels are equal)";

namespace {

// What is wrong with one of them, or nothing.
std::string readThresholds(const std::vector<std::string>& texts, CompareOptions& options) {
    options.thresholds.clear();
    for (const std::string& text : texts) {
        auto threshold = readThreshold(text);
        if (const auto* problem = std::get_if<std::string>(&threshold)) return *problem;
        options.thresholds.push_back(std::get<CompareThreshold>(threshold));
    }
    return {};
}

std::string unknownFigure(const std::string& name) {
    std::vector<std::string_view> names;
    for (const CompareFigure& figure : compareFigures()) names.emplace_back(figure.name);
    const std::string_view near = schema::nearest(name, names);
    return fmt::format("no figure is named `{}`{}; there are {}", name,
                       near.empty() ? "" : fmt::format(" (did you mean `{}`?)", near), fmt::join(names, ", "));
}

} // namespace

void addArguments(Arguments& a, CompareOptions& o) {
    a.argument("image", &o.image, "EXR or .hdr").require();
    a.argument("other", &o.other, "Image to compare with; with --ref its rival");
    a.value("--ref", "FILE", &o.references, "Compare with this; a second one of another seed cancels its noise");
    a.value(
        "--threshold", "FIGURE=X", [&o](const std::vector<std::string>& texts) { return readThresholds(texts, o); },
        "Exit with 4 beyond this bound: flip=0.05; a number alone is for relmse; may be repeated");
    a.value("--html", "FILE", &o.html, "Write a page to look at the images");
    a.value("--ppd", "N", &o.pixelsPerDegree, "Pixels per degree of the observer for FLIP; 67 when absent")
        .between(1, 1000);
    addJson(a);
    a.afterwards([&o]() -> std::optional<ArgumentFault> {
        if (!o.other && o.references.empty()) return ArgumentFault{"compare", "an image to compare with is missing"};
        if (o.references.size() > 2) return ArgumentFault{"--ref", "more than two references have no meaning"};
        return std::nullopt;
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

namespace {

// The images under test, what they are measured against, and the result.
struct Comparison {
    std::vector<CompareImage> images;     // one or two
    std::vector<CompareImage> references; // one or two
    CompareImage reference;               // their mean
    std::vector<CompareFigures> figures;  // of each image
};

// `compare IMAGE OTHER` measures IMAGE against OTHER; with --ref both are measured against the references.
Comparison read(const CompareOptions& options) {
    Comparison c;
    c.images.push_back(CompareImage::read(options.image));
    auto& others = options.references.empty() ? c.references : c.images;
    if (options.other) others.push_back(CompareImage::read(*options.other));
    for (const std::string& path : options.references) c.references.push_back(CompareImage::read(path));
    return c;
}

std::optional<std::string> fault(const Comparison& c) {
    const CompareImage& first = c.references.front();
    for (const auto* images : {&c.images, &c.references})
        for (const CompareImage& image : *images) {
            if (image.picture.rgb.empty()) return fmt::format("`{}` has no pixels", image.path);
            if (const auto found = comparisonFault(image.picture, first.picture))
                return fmt::format("`{}` and `{}` cannot be compared: {}", image.path, first.path, *found);
        }
    return std::nullopt;
}

// Why a threshold cannot be judged, or nothing.
std::optional<std::string> thresholdFault(const CompareOptions& options, const Comparison& c) {
    for (const CompareThreshold& threshold : options.thresholds) {
        if (threshold.figure != "agreement") continue;
        for (const auto* images : {&c.images, &c.references})
            for (const CompareImage& image : *images)
                if (image.variance.empty())
                    return fmt::format("`--threshold agreement` needs the channel variance.Y in every image, and `{}` "
                                       "has none (the film writes it for two replicates or more)",
                                       image.path);
    }
    return std::nullopt;
}

char letter(std::size_t image) { return static_cast<char>('a' + image); }

// The image that a figure puts nearer to the reference, or nothing for equal ones and for one image.
std::optional<std::size_t> nearer(const Comparison& c, const CompareFigure& figure) {
    if (c.figures.size() < 2) return std::nullopt;
    double a = figure.value(c.figures[0]), b = figure.value(c.figures[1]);
    if (figure.name == std::string_view("relmse") && c.figures[0].unbiased) a = std::abs(a), b = std::abs(b);
    if (std::isnan(a) || std::isnan(b) || a == b) return std::nullopt;
    return (figure.atLeast ? a > b : a < b) ? 0 : 1;
}

std::string table(const Comparison& c) {
    std::string text;
    const auto line = [&](std::string_view label, const std::vector<std::string>& cells) {
        text += fmt::format("{:<30}", label);
        for (const std::string& cell : cells) text += fmt::format("{:>14}", cell);
        text += '\n';
    };
    if (c.images.size() == 2) {
        text += fmt::format("a          {}\nb          {}\n", c.images[0].path, c.images[1].path);
        text += fmt::format("reference  {}\n", c.reference.path);
        line("", {"a", "b", "nearer"});
    }
    for (const CompareFigure& figure : compareFigures()) {
        if (figure.name == std::string_view("agreement")) continue; // the verdicts below say it
        std::vector<std::string> cells;
        for (const CompareFigures& figures : c.figures) cells.push_back(figure.text(figures));
        if (const auto best = nearer(c, figure)) cells.emplace_back(1, letter(*best));
        line(figure.label, cells);
        if (figure.name == std::string_view("relmse") && c.figures[0].unbiased)
            text += "  (the noise of the references cancels)\n";
    }
    line("mean ratio", [&] {
        std::vector<std::string> cells;
        for (const CompareFigures& f : c.figures) cells.push_back(fmt::format("{:.6f}", f.difference.meanRatio));
        return cells;
    }());
    return text;
}

std::string verdicts(const Comparison& c) {
    std::string text;
    for (std::size_t i = 0; i < c.figures.size(); ++i) {
        const std::string who = c.images.size() == 2 ? fmt::format("{}: ", letter(i)) : "";
        const auto& t = c.figures[i].tiles;
        if (!t) continue;
        text += fmt::format("{}{} ({} tiles of 8×8; the scores have a mean of {:.3f} and a deviation of {:.3f}; "
                            "p = {:.2g} for their distribution, {:.2g} for the largest)\n",
                            who, t->verdict(), t->tiles, t->mean, t->deviation, t->kolmogorovProbability,
                            t->largestProbability);
    }
    return text;
}

// The thresholds that an image exceeds, one line each.
std::vector<std::string> exceeded(const CompareOptions& options, const Comparison& c) {
    std::vector<std::string> lines;
    for (const CompareThreshold& threshold : options.thresholds)
        for (std::size_t i = 0; i < c.figures.size(); ++i) {
            const CompareFigure& figure = *findCompareFigure(threshold.figure);
            if (figure.within(c.figures[i], threshold.value)) continue;
            lines.push_back(fmt::format("{} of `{}` is {}, not {} {:g}", figure.name, c.images[i].path,
                                        figure.text(c.figures[i]), figure.atLeast ? "at least" : "at most",
                                        threshold.value));
        }
    return lines;
}

std::string json(const Comparison& c, const std::vector<std::string>& failures) {
    Json all = c.figures[0].json();
    if (c.images.size() == 2) {
        Json best = Json::object();
        for (const CompareFigure& figure : compareFigures())
            if (const auto image = nearer(c, figure)) best.set(figure.name, std::string(1, letter(*image)));
        all = Json::object({{"a", c.figures[0].json().set("path", c.images[0].path)},
                            {"b", c.figures[1].json().set("path", c.images[1].path)},
                            {"nearer", best}});
    }
    Json references = Json::list(), exceeding = Json::list();
    for (const CompareImage& reference : c.references) references.push(reference.path);
    for (const std::string& failure : failures) exceeding.push(failure);
    return all.set("references", references).set("exceeded", exceeding).text() + "\n";
}

void writePage(const std::string& path, const Comparison& c, const Console& console) {
    ComparePage page;
    const bool rivals = c.images.size() == 2;
    const auto fileName = [](const std::string& p) { return std::filesystem::path(p).filename().string(); };
    for (std::size_t i = 0; i < c.images.size(); ++i) {
        page.images.push_back({fileName(c.images[i].path), c.images[i].path, i == 0 ? 'A' : 'B', &c.images[i].picture});
        if (c.figures[i].flip) page.maps.push_back({i, c.figures[i].flip->map});
    }
    const std::string name = c.references.size() == 2 ? "mean of the references" : fileName(c.reference.path);
    page.images.push_back({name, c.reference.path, rivals ? 'R' : 'B', &c.reference.picture});
    page.title = fmt::format("{} – {}", page.images.front().name, page.images.back().name);
    for (const CompareFigure& figure : compareFigures()) {
        std::vector<std::string> cells;
        for (const CompareFigures& figures : c.figures) cells.push_back(figure.text(figures));
        page.figures.push_back({figure.label, std::move(cells)});
    }
    page.verdict = verdicts(c);
    writeComparePage(path, page);
    const RgbImage& picture = c.reference.picture;
    if (const int block = pageBlock(picture.width(), picture.height()); block > 1)
        console.line(fmt::format("the images are too large for a page: it shows means of {0}×{0} pixels", block));
    console.line(fmt::format("page {}", path));
}

} // namespace

ExitCode run(const CompareOptions& options, const CommonOptions& common) {
    Comparison c = read(options);
    auto found = fault(c);
    if (!found) found = thresholdFault(options, c);
    if (found) {
        common.console.error(*found);
        return ExitCode::faulty;
    }
    c.reference = CompareImage::mean(c.references);
    for (const CompareImage& image : c.images)
        c.figures.push_back(CompareFigures::measure(image, c.references, c.reference, options.pixelsPerDegree));
    const std::vector<std::string> failures = exceeded(options, c);
    common.console.data(common.json ? json(c, failures) : table(c) + verdicts(c));
    if (options.html) writePage(*options.html, c, common.console);
    for (const std::string& failure : failures) common.console.line("beyond the threshold: " + failure);
    return failures.empty() ? ExitCode::done : ExitCode::threshold;
}

} // namespace abbe

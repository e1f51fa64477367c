#include "base/diagnostic_format.h"

#include "base/diagnostic_order.h"
#include "base/shown_text.h"
#include "base/source_excerpt.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

namespace {

// What comes from a scene must not reach the terminal as commands.
Diagnostic asShown(Diagnostic d) {
    for (std::string* text : {&d.message, &d.label, &d.help}) *text = shownLine(*text);
    for (Label& label : d.related) label.text = shownLine(label.text);
    for (std::string& note : d.notes) note = shownLine(note);
    return d;
}

enum class Style { error, warning, frame, strong };

// Writes diagnostics in the manner of compilers, all with one width of line numbers.
class HumanWriter {
  public:
    HumanWriter(const SourceMap& sources, bool color, std::size_t width)
        : sources_(sources), color_(color), width_(width) {}

    void write(const Diagnostic& found) {
        const Diagnostic d = asShown(found);
        const bool isError = d.severity == Severity::error;
        const Style style = isError ? Style::error : Style::warning;
        out_ += paint(style, fmt::format("{}[{}]", isError ? "error" : "warning", d.code));
        out_ += paint(Style::strong, fmt::format(": {}", d.message)) + "\n";
        // A file that could not be read has no text to show.
        if (d.span.valid() && !sources_.text(d.span.file).empty())
            writePlace(d, style);
        else
            writeFarLabels(d.related);
        for (const std::string& note : d.notes) writeRemark("note", note);
        if (!d.help.empty()) writeRemark("help", d.help);
        out_ += "\n";
    }
    std::string take() { return std::move(out_); }

  private:
    void writePlace(const Diagnostic& d, Style style) {
        const LineColumn place = sources_.lineColumn(d.span.file, d.span.begin);
        std::vector<Underline> near;
        std::vector<Label> far;
        for (const Label& label : d.related) {
            const bool sameLine = label.span.valid() && label.span.file == d.span.file &&
                                  sources_.lineColumn(label.span.file, label.span.begin).line == place.line;
            if (sameLine)
                near.push_back({label.span, label.text, false});
            else
                far.push_back(label);
        }
        const Excerpt excerpt = makeExcerpt(sources_, {d.span, d.label, true}, near);
        for (const Underline& cut : excerpt.notShown) far.push_back({cut.span, cut.label});
        writeArrow(d.span.file, place);
        writeGutter("");
        writeGutter(std::to_string(place.line), excerpt.source);
        for (const std::string& line : excerpt.below) writeGutter("", line, style);
        writeFarLabels(far);
    }

    void writeArrow(FileId file, LineColumn place) {
        out_ += std::string(width_, ' ') + paint(Style::frame, "--> ");
        out_ += fmt::format("{}:{}:{}\n", shownLine(sources_.path(file)), place.line, place.column);
    }
    void writeGutter(std::string_view number, std::string_view text = {}) {
        out_ += paint(Style::frame, fmt::format("{:>{}} |", number, width_));
        if (!text.empty()) out_ += fmt::format(" {}", text);
        out_ += "\n";
    }
    void writeGutter(std::string_view number, std::string_view text, Style style) {
        out_ += paint(Style::frame, fmt::format("{:>{}} |", number, width_));
        out_ += " " + paint(style, text) + "\n";
    }
    void writeFarLabels(const std::vector<Label>& labels) {
        for (const Label& label : labels) {
            out_ += paint(Style::strong, "note") + fmt::format(": {}\n", label.text);
            if (label.span.valid()) writeArrow(label.span.file, sources_.lineColumn(label.span.file, label.span.begin));
        }
    }
    void writeRemark(std::string_view kind, std::string_view text) {
        out_ += std::string(width_ + 1, ' ') + paint(Style::frame, "= ") + paint(Style::strong, kind);
        out_ += fmt::format(": {}\n", text);
    }
    std::string paint(Style style, std::string_view text) const {
        if (!color_) return std::string(text);
        constexpr std::string_view codes[] = {"1;31", "1;33", "1;34", "1"};
        return fmt::format("\x1b[{}m{}\x1b[0m", codes[static_cast<std::size_t>(style)], text);
    }

    const SourceMap& sources_;
    const bool color_;
    const std::size_t width_;
    std::string out_;
};

std::string counted(std::size_t n, std::string_view what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

// `broken.scene: 9 errors, 0 warnings. …` with what the user can type next.
std::string summary(const Diagnostics& diagnostics, const std::vector<const Diagnostic*>& sorted,
                    const SourceMap& sources, std::string name) {
    if (name.empty() && sorted[0]->span.valid()) name = sources.path(sorted[0]->span.file);
    const auto fixable =
        std::count_if(sorted.begin(), sorted.end(), [](const Diagnostic* d) { return !d->fixes.empty(); });
    // The one with the longest story: a place that is connected to another.
    const auto connected =
        std::find_if(sorted.begin(), sorted.end(), [](const Diagnostic* d) { return !d->related.empty(); });
    const Diagnostic& explained = connected == sorted.end() ? *sorted[0] : **connected;
    std::string line = name.empty() ? std::string{} : shownLine(name) + ": ";
    line += fmt::format("{}, {}. ", counted(diagnostics.errorCount(), "error"),
                        counted(diagnostics.warningCount(), "warning"));
    const std::string all = sorted.size() == 1 ? "it" : fmt::format("{} of them", fixable);
    if (fixable > 0) line += fmt::format("`abbe check --fix` repairs {}; ", all);
    return line + fmt::format("`abbe explain {}` says more.\n", explained.code);
}

// The first `most` errors and the first `most` warnings.
std::vector<const Diagnostic*> firstOf(const std::vector<const Diagnostic*>& sorted, std::size_t most) {
    std::vector<const Diagnostic*> chosen;
    std::size_t counts[2] = {0, 0};
    for (const Diagnostic* d : sorted)
        if (counts[d->severity == Severity::error ? 0 : 1]++ < most) chosen.push_back(d);
    return chosen;
}

} // namespace

std::string formatHuman(const Diagnostics& diagnostics, const SourceMap& sources, const FormatOptions& options) {
    const std::vector<const Diagnostic*> sorted = sortedByPlace(diagnostics);
    if (sorted.empty()) return {};
    const std::vector<const Diagnostic*> shown = firstOf(sorted, options.maxErrors);
    std::uint32_t lastLine = 10; // at least two digits, so that short files look alike
    for (const Diagnostic* d : shown)
        if (d->span.valid()) lastLine = std::max(lastLine, sources.lineColumn(d->span.file, d->span.begin).line);
    HumanWriter writer(sources, options.color, std::to_string(lastLine).size());
    for (const Diagnostic* d : shown) writer.write(*d);
    std::string text = writer.take();
    const std::size_t found = diagnostics.errorCount() + diagnostics.warningCount();
    if (const std::size_t hidden = found - shown.size(); hidden > 0) text += fmt::format("… and {} more\n\n", hidden);
    return text + summary(diagnostics, sorted, sources, options.summaryName);
}

std::string formatShort(const Diagnostics& diagnostics, const SourceMap& sources) {
    std::string text;
    for (const Diagnostic* found : sortedByPlace(diagnostics)) {
        const Diagnostic d = asShown(*found);
        if (d.span.valid()) {
            const LineColumn place = sources.lineColumn(d.span.file, d.span.begin);
            text += fmt::format("{}:{}:{}: ", shownLine(sources.path(d.span.file)), place.line, place.column);
        }
        text += fmt::format("{}[{}]: {}", d.severity == Severity::error ? "error" : "warning", d.code, d.message);
        if (!d.label.empty()) text += fmt::format(" ({})", d.label);
        text += "\n";
    }
    return text;
}

} // namespace abbe

#include "base/diagnostic_format.h"

#include "base/diagnostic.h"
#include "base/source.h"
#include "base/text.h"

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace abbe {

namespace {

// A part of the line: `^` for the primary one, `-` for others.
struct Underline {
    Span span;
    std::string label;
    bool primary = false;
};

// One line of a source text with carets and dashes under its parts.
struct Excerpt {
    std::string source;              // the line as shown: tabs as spaces, very long lines cut around the primary part
    std::vector<std::string> below;  // the lines under it
    std::vector<Underline> notShown; // parts outside of what was cut out
};

constexpr std::size_t kTab = 4;       // columns between tab stops
constexpr std::size_t kLongest = 120; // lines with more columns are cut
constexpr std::size_t kBefore = 40;   // columns kept before the primary part of a cut line
constexpr std::size_t kWindow = 100;  // columns kept in all

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0u) == 0x80u; }

// A line as shown, with the column of each of its bytes.
class ShownLine {
  public:
    // `from` and `to` are the bytes to show, on boundaries of characters.
    ShownLine(std::string_view line, std::size_t from, std::size_t to) : from_(from), to_(to) {
        if (from > 0) append("…");
        for (std::size_t i = from; i < to;) {
            const FirstCharacter c = firstCharacter(line.substr(i, to - i));
            columns_.insert(columns_.end(), c.bytes, width_);
            if (line[i] == '\t')
                appendTab();
            else
                append(c.control ? "\xef\xbf\xbd" : line.substr(i, c.bytes)); // would disturb what is shown around it
            i += c.bytes;
        }
        columns_.push_back(width_);
        if (to < line.size()) append("…");
    }
    const std::string& text() const { return text_; }
    bool shows(std::size_t byte) const { return byte >= from_ && byte <= to_; }
    std::size_t column(std::size_t byte) const { return columns_[std::clamp(byte, from_, to_) - from_]; }

  private:
    void append(std::string_view character) {
        text_ += character;
        ++width_;
    }
    void appendTab() {
        do append(" ");
        while (width_ % kTab != 0);
    }
    std::size_t from_, to_;
    std::size_t width_ = 0;
    std::string text_;
    std::vector<std::size_t> columns_;
};

// The bytes of a line to show: all of them, or a window around `byte`.
ShownLine show(std::string_view line, std::size_t byte) {
    if (line.size() <= kLongest) return {line, 0, line.size()};
    std::size_t from = std::min(byte, line.size());
    for (std::size_t n = 0; n < kBefore && from > 0; ++n) do
            --from;
        while (from > 0 && continues(line[from]));
    std::size_t to = from;
    for (std::size_t n = 0; n < kWindow && to < line.size(); ++n) do
            ++to;
        while (to < line.size() && continues(line[to]));
    return {line, from, to};
}

struct Part {
    std::size_t first, last; // columns, half open
    const Underline* underline;
};

void write(std::string& line, std::size_t column, std::size_t count, char c) {
    if (line.size() < column + count) line.resize(column + count, ' ');
    for (std::size_t i = column; i < column + count; ++i) line[i] = c;
}

// The marks, with the label of the rightmost part behind them, and the other labels below, from right to left.
std::vector<std::string> drawParts(std::vector<Part> parts) {
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.first > b.first; });
    std::string marks;
    for (const bool primary : {false, true})
        for (const Part& part : parts)
            if (part.underline->primary == primary)
                write(marks, part.first, part.last - part.first, primary ? '^' : '-');
    std::vector<std::string> lines;
    const bool fits = parts[0].last == marks.size();
    if (fits && !parts[0].underline->label.empty()) marks += " " + parts[0].underline->label;
    lines.push_back(marks);
    for (std::size_t i = fits ? 1 : 0; i < parts.size(); ++i)
        if (!parts[i].underline->label.empty())
            lines.push_back(std::string(parts[i].first, ' ') + parts[i].underline->label);
    return lines;
}

Excerpt makeExcerpt(const SourceMap& sources, const Underline& primary, const std::vector<Underline>& others) {
    const FileId file = primary.span.file;
    const std::string_view line = sources.line(file, sources.lineColumn(file, primary.span.begin).line);
    const std::size_t start = static_cast<std::size_t>(line.data() - sources.text(file).data());
    const ShownLine shown = show(line, primary.span.begin - start);
    Excerpt excerpt;
    excerpt.source = shown.text();
    std::vector<Part> parts;
    const auto add = [&](const Underline& u) {
        const std::size_t first = shown.column(u.span.begin - start);
        const std::size_t last = shown.column(std::max<std::size_t>(u.span.end, start) - start);
        parts.push_back({first, std::max(last, first + 1), &u});
    };
    add(primary);
    for (const Underline& other : others) {
        if (shown.shows(other.span.begin - start))
            add(other);
        else
            excerpt.notShown.push_back(other);
    }
    excerpt.below = drawParts(std::move(parts));
    return excerpt;
}

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

namespace {

// LSP counts lines from 0 and characters in UTF-16 units.
std::string position(const SourceMap& sources, FileId file, std::uint32_t offset) {
    return fmt::format("{{\"line\":{},\"character\":{}}}", sources.lineColumn(file, offset).line - 1,
                       sources.utf16Column(file, offset));
}

std::string range(const SourceMap& sources, Span span) {
    return fmt::format("{{\"start\":{},\"end\":{}}}", position(sources, span.file, span.begin),
                       position(sources, span.file, span.end));
}

std::string relatedInformation(const Diagnostic& d, const SourceMap& sources) {
    std::string list;
    for (const Label& label : d.related) {
        if (!label.span.valid()) continue;
        list += fmt::format("{}{{\"location\":{{\"uri\":{},\"range\":{}}},\"message\":{}}}", list.empty() ? "" : ",",
                            jsonText(sources.path(label.span.file)), range(sources, label.span), jsonText(label.text));
    }
    return list;
}

std::string extraData(const Diagnostic& d, const SourceMap& sources) {
    std::string notes, fixes;
    for (const std::string& note : d.notes) notes += fmt::format("{}{}", notes.empty() ? "" : ",", jsonText(note));
    for (const FixIt& fix : d.fixes)
        fixes += fmt::format("{}{{\"range\":{},\"newText\":{}}}", fixes.empty() ? "" : ",", range(sources, fix.span),
                             jsonText(fix.replacement));
    return fmt::format("{{\"label\":{},\"notes\":[{}],\"help\":{},\"fixes\":[{}]}}", jsonText(d.label), notes,
                       jsonText(d.help), fixes);
}

} // namespace

std::string formatJson(const Diagnostics& diagnostics, const SourceMap& sources) {
    std::string list;
    for (const Diagnostic* d : sortedByPlace(diagnostics)) {
        list += list.empty() ? "\n" : ",\n";
        const std::string path = d->span.valid() ? jsonText(sources.path(d->span.file)) : "null";
        const std::string place = d->span.valid() ? range(sources, d->span)
                                                  : "{\"start\":{\"line\":0,\"character\":0},\"end\":{\"line\":0,"
                                                    "\"character\":0}}";
        const std::string message = d->label.empty() ? d->message : fmt::format("{} ({})", d->message, d->label);
        list += fmt::format("{{\"path\":{},\"range\":{},\"severity\":{},\"code\":{},\"source\":\"abbe\",\"message\":{},"
                            "\"relatedInformation\":[{}],\"data\":{}}}",
                            path, place, d->severity == Severity::error ? 1 : 2, jsonText(d->code), jsonText(message),
                            relatedInformation(*d, sources), extraData(*d, sources));
    }
    return fmt::format("[{}{}]\n", list, list.empty() ? "" : "\n");
}

} // namespace abbe

#include "base/source_excerpt.h"

#include "base/shown_text.h"

#include <algorithm>

namespace abbe {

namespace {

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

} // namespace

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

} // namespace abbe

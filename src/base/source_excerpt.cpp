#include "base/source_excerpt.h"

#include <algorithm>

namespace abbe {

namespace {

constexpr std::size_t kTab = 4;       // columns between tab stops
constexpr std::size_t kLongest = 120; // lines with more columns are cut
constexpr std::size_t kBefore = 40;   // columns kept before the primary part of a cut line
constexpr std::size_t kWindow = 100;  // columns kept in all

// Code points that change the direction of writing, and the byte order mark, would disturb what is shown around them.
bool isInvisible(std::string_view text) {
    if (text.size() < 3) return false;
    const auto last = static_cast<unsigned char>(text[2]);
    const std::string_view lead = text.substr(0, 2);
    if (lead == "\xe2\x80") return last == 0x8e || last == 0x8f || (last >= 0xaa && last <= 0xae);
    if (lead == "\xe2\x81") return last >= 0xa6 && last <= 0xa9;
    return text.starts_with("\xef\xbb\xbf");
}

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0u) == 0x80u; }

// A line as shown, with the column of each of its bytes.
class ShownLine {
  public:
    // `from` and `to` are the bytes to show, on boundaries of characters.
    ShownLine(std::string_view line, std::size_t from, std::size_t to) : from_(from), to_(to) {
        if (from > 0) append("…");
        std::size_t hiddenEnd = 0;
        for (std::size_t i = from; i < to; ++i) {
            if (!continues(line[i]) || i == from)
                columns_.push_back(width_);
            else
                columns_.push_back(columns_.back());
            if (i < hiddenEnd) continue;
            if (isInvisible(line.substr(i))) {
                append("\xef\xbf\xbd");
                hiddenEnd = i + 3;
            } else {
                appendByte(line[i]);
            }
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
    void appendByte(char c) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '\t') {
            do append(" ");
            while (width_ % kTab != 0);
        } else if (byte < 0x20 || byte == 0x7f) {
            append("\xef\xbf\xbd"); // a control character would disturb the terminal
        } else if (continues(c)) {
            text_ += c;
        } else {
            append({&c, 1});
        }
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

#include "parser/brace_lines.h"

#include "parser/characters.h"
#include "parser/text_literal.h"
#include "parser/whitespace.h"

#include <algorithm>

namespace abbe::parser {

namespace {

// Past the comment that begins with `/*` at `p`; such comments nest. Null without an end.
const char* skipNestedComment(const char* p, const char* end) {
    int depth = 0;
    for (; p + 1 < end; ++p) {
        const bool opens = p[0] == '/' && p[1] == '*';
        if (!opens && !(p[0] == '*' && p[1] == '/')) continue;
        depth += opens ? 1 : -1;
        ++p;
        if (depth == 0) return p + 1;
    }
    return nullptr;
}

class LineCollector {
  public:
    explicit LineCollector(const SourceText& text) : text_(text), errors_(text, ignored_) {}

    // False where something has no end.
    bool collect() {
        const char* p = text_.begin;
        while (p != nullptr && p < text_.end) {
            if (const std::uint32_t n = newlineLength(p, text_.end); n > 0) {
                endLine();
                lineStart_ = p += n;
            } else if (p[0] == '/' && p[1] == '/') {
                p = findLineEnd(p, text_.end);
            } else if (p[0] == '/' && p[1] == '*') {
                p = skipNestedComment(p, text_.end);
            } else if (startsText(p)) {
                p = text(p);
            } else if (const std::uint32_t blank = blankLength(p, text_.end); blank > 0) {
                p += blank;
            } else {
                note(p++);
            }
        }
        endLine();
        return p != nullptr;
    }
    std::vector<BraceLine> lines;

  private:
    const char* text(const char* p) {
        const TextLiteral literal = scanText(p, errors_, scratch_);
        if (literal.lost) return nullptr;
        note(p);
        line_.last = literal.end - 1;
        return literal.end;
    }

    void note(const char* p) {
        if (line_.first == nullptr) {
            line_.first = p;
            line_.indent = p - lineStart_;
        }
        line_.last = p;
        if (std::string_view("{}()[]").find(*p) != std::string_view::npos) line_.tokens.push_back({p, *p});
    }

    void endLine() {
        if (line_.first != nullptr) {
            line_.continued = *line_.last == '\\';
            lines.push_back(std::move(line_));
        }
        line_ = {};
    }

    const SourceText& text_;
    Diagnostics ignored_;
    SyntaxErrors errors_;
    schema::Document scratch_;
    const char* lineStart_ = text_.begin;
    BraceLine line_;
};

} // namespace

std::string_view BraceLine::word() const {
    const char lower = static_cast<char>(*first | 0x20);
    if (lower < 'a' || lower > 'z') return {};
    return between(first, std::find_if(first, last + 1, [](char c) { return !has(c, kWord); }));
}

std::ptrdiff_t BraceLine::opened() const {
    std::ptrdiff_t open = 0;
    for (const BraceToken& t : tokens) {
        if (t.kind == '{') ++open;
        if (t.kind == '}' && open > 0) --open;
    }
    return open;
}

std::ptrdiff_t BraceLine::closed() const {
    std::ptrdiff_t open = 0, closed = 0;
    for (const BraceToken& t : tokens) {
        if (t.kind == '{') ++open;
        if (t.kind != '}') continue;
        if (open > 0)
            --open;
        else
            ++closed;
    }
    return closed;
}

std::vector<BraceLine> braceLines(const SourceText& text) {
    LineCollector collector(text);
    if (!collector.collect()) return {};
    return std::move(collector.lines);
}

} // namespace abbe::parser

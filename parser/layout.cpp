// The layout of scene files (docs/language/syntax.md, "Layout"): one pass over the tokens, which are written again with
// other line ends and indentation. Between two tokens of a line nothing changes, so what was aligned by hand stays so.
#include "parser/characters.h"
#include "parser/parse.h"
#include "parser/tokens.h"
#include "parser/value_scanner.h"
#include "schema/describe.h"

#include <algorithm>
#include <bit>
#include <vector>

namespace abbe {

namespace parser {

namespace {

constexpr std::size_t kIndent = 4;  // columns a level
constexpr std::size_t kWidth = 100; // columns of a line with a block in it
constexpr int kElsewhere = 1 << 30; // column of what begins no line of the source: anything is left of it

// Columns of white space; a tab reaches to the next level.
int columnsOf(std::string_view blanks) {
    int columns = 0;
    for (const char* p = blanks.data(); p < blanks.data() + blanks.size();) {
        columns = *p == '\t' ? (columns / 4 + 1) * 4 : columns + 1;
        p += std::max(decodeUtf8(p, blanks.data() + blanks.size()).length, 1u);
    }
    return columns;
}

bool endsNode(TokenKind kind) {
    return kind == TokenKind::lineEnd || kind == TokenKind::lineComment || kind == TokenKind::semicolon ||
           kind == TokenKind::close || kind == TokenKind::end;
}

bool isComment(TokenKind kind) { return kind == TokenKind::lineComment || kind == TokenKind::blockComment; }

// What of a node has been read so far, to tell names from values.
struct Head {
    bool named = false;
    bool inType = false; // between the parentheses of a type annotation
};

class Layout {
  public:
    explicit Layout(std::string_view text)
        : text_{FileId::none, text.data(), text.data() + text.size()}, errors_(text_, ignored_), at_(text_.begin) {}

    std::string write() {
        out_.reserve(static_cast<std::size_t>(text_.end - text_.begin) + 64);
        if (std::string_view(text_.begin, text_.end).starts_with("\xef\xbb\xbf")) print(take(3));
        first_ = out_.size();
        findLineEnd();
        nodes(0, false);
        if (out_.size() > first_) endLine();
        return std::move(out_);
    }

  private:
    // Where a block's lines have got to.
    struct Lines {
        std::size_t depth = 0;
        bool any = false;      // something was printed in it
        bool sameLine = false; // and nothing ended the source line since
        bool lineStart = false;
        bool leading = false;   // a comment that the next node of the line stands behind
        bool semicolon = false; // behind the last node
        int lineEnds = 0;       // since something was printed
        bool plain = false;     // the last node is a line without a block, of this name
        std::string_view name = {};
        bool opened = false; // the block stood on one line: of nodes of one name only `-` rows stay together
    };

    // Where a line begins: in the source, or kElsewhere, and in what is printed.
    struct LineColumns {
        int was = 0, is = 0;
    };

    Token next(const char* p) { return nextToken(p, errors_, scratch_); }
    std::string_view take(std::size_t count) {
        const char* const from = at_;
        at_ += count;
        return between(from, at_);
    }

    // Line ends are all like the first one, but for those in texts and comments.
    void findLineEnd() {
        for (Token t = next(at_); t.kind != TokenKind::end; t = next(t.end)) {
            if (t.kind != TokenKind::lineEnd) continue;
            if (t.text() == "\r\n") lineEnd_ = "\r\n";
            return;
        }
    }

    // Printing ---------------------------------------------------------------------------------------------------

    void print(std::string_view text) { out_ += text; }
    // What may have line ends inside.
    void printBroken(std::string_view text) {
        out_ += text;
        const std::size_t last = text.find_last_of("\n\r\v\f");
        if (last != std::string_view::npos) lineBegin_ = out_.size() - (text.size() - last - 1);
    }
    void endLine() {
        out_ += lineEnd_;
        lineBegin_ = out_.size();
    }
    void indent(std::size_t columns) { out_.append(columns, ' '); }
    void needBlank() {
        if (!out_.empty() && out_.back() != ' ' && out_.back() != '\t') out_ += ' ';
    }
    // Before a brace that ends its line nothing can be aligned.
    void oneBlank() {
        const std::size_t end = out_.find_last_not_of(" \t");
        if (end != std::string::npos && end >= lineBegin_ && out_.size() > end + 2)
            out_.replace(end + 1, std::string::npos, " ");
    }
    // Whether the last line is longer than a line with a block may be. A code point is a column.
    bool tooWide() const {
        const std::size_t bytes = out_.size() - lineBegin_;
        if (bytes <= kWidth || bytes > 4 * kWidth) return bytes > kWidth;
        const auto starts = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
        return std::ranges::count_if(out_.begin() + static_cast<std::ptrdiff_t>(lineBegin_), out_.end(), starts) >
               static_cast<std::ptrdiff_t>(kWidth);
    }

    // A line of its own for what begins at `column` of the source.
    void startLine(Lines& lines, int column) {
        if (out_.size() > first_) endLine();
        if (lines.any && lines.lineEnds > 1) endLine();
        indent(kIndent * lines.depth);
        line_ = {column, static_cast<int>(kIndent * lines.depth)};
    }

    void printLineComment(std::string_view comment) {
        const char* end = comment.data() + comment.size();
        for (const char* p = end; p > comment.data();) { // without the white space at its end
            const char* q = p - 1;
            while (q > comment.data() && (static_cast<unsigned char>(*q) & 0xc0) == 0x80) --q;
            if (blankLength(q, text_.end) == 0) break;
            end = p = q;
        }
        print(between(comment.data(), end));
    }

    // A comment moves as a whole: its other lines by as much as the first one.
    void printBlockComment(std::string_view comment) {
        const int shift = line_.was == kElsewhere ? 0 : line_.is - line_.was;
        const char* p = comment.data();
        const char* const end = p + comment.size();
        const char* line = p;
        while (shift != 0 && p < end) {
            const std::uint32_t newline = newlineLength(p, end);
            if (newline == 0) {
                ++p;
                continue;
            }
            printBroken(between(line, p += newline));
            line = p;
            while (blankLength(p, end) > 0) p += blankLength(p, end);
            if (newlineLength(p, end) > 0) continue; // an empty line
            indent(static_cast<std::size_t>(std::max(columnsOf(between(line, p)) + shift, 0)));
            line = p;
        }
        printBroken(between(line, end));
    }

    // Names in quotes that they do not need lose them; as a value "a" is a text, which `a` is not.
    void printText(const Token& token, Head& head) {
        const bool name = !head.inType && (!head.named || isKey(token.end));
        if (!head.inType) head.named = true;
        printBroken(name ? withoutQuotes(token) : token.text());
    }
    bool isKey(const char* p) {
        bool lineComment = false;
        return *skipNodeSpace(p, errors_, lineComment) == '=';
    }
    static std::string_view withoutQuotes(const Token& token) {
        const std::string_view text = token.text();
        if (text.size() < 3 || text.front() != '"') return text;
        const std::string_view inside = text.substr(1, text.size() - 2);
        const char* const p = inside.data();
        const bool word = wordEnd(p, p + inside.size()) == p + inside.size() && !startsNumber(p) &&
                          !startsPointNumber(p) && !isBareKeyword(inside);
        const bool otherQuotes = *p == '\'' || inside.starts_with("\xe2\x80\x9c"); // E0114
        return word && !otherQuotes ? inside : text;
    }

    void printToken(const Token& token, Head& head) {
        if (token.kind == TokenKind::text) return printText(token, head);
        if (token.kind == TokenKind::openType) head.inType = true;
        if (token.kind == TokenKind::closeType) head.inType = false;
        if (token.kind == TokenKind::word && !head.inType) head.named = true;
        print(token.text());
    }

    // Nodes --------------------------------------------------------------------------------------------------------

    // Those of a block up to its brace, or of the file. `behindBrace`: on the line of the `{`.
    void nodes(std::size_t depth, bool behindBrace, bool opened = false) {
        Lines lines{.depth = depth, .sameLine = behindBrace, .lineStart = !behindBrace, .opened = opened};
        for (;;) {
            const char* gap = at_;
            Token token = next(at_);
            if (token.kind == TokenKind::blank) token = next(token.end);
            if (token.kind == TokenKind::end || token.kind == TokenKind::close) {
                at_ = token.begin;
                return;
            }
            const std::string_view blanks = between(gap, token.begin);
            if (endsNode(token.kind) && token.kind != TokenKind::lineComment) { // a line end or a semicolon
                passEnd(token, lines);
            } else if (token.kind == TokenKind::continuation) { // between nodes it means nothing
                at_ = token.end;
            } else if (isComment(token.kind)) {
                comment(token, blanks, lines);
            } else {
                node(token, blanks, lines);
            }
        }
    }

    void passEnd(const Token& token, Lines& lines) {
        at_ = token.end;
        if (token.kind == TokenKind::semicolon) {
            lines.semicolon = true;
            return;
        }
        ++lines.lineEnds;
        lines.lineStart = true;
        lines.sameLine = lines.leading = false;
    }

    void comment(const Token& token, std::string_view blanks, Lines& lines) {
        const bool block = token.kind == TokenKind::blockComment;
        if (lines.sameLine && (!block || lines.leading || !leadsNode(token.end))) {
            print(blanks.empty() ? " " : blanks);
        } else {
            startLine(lines, lines.lineStart ? columnsOf(blanks) : kElsewhere);
            lines.leading = block;
            lines.plain = false;
        }
        if (block)
            printBlockComment(token.text());
        else
            printLineComment(token.text());
        printed(token.end, lines);
    }

    void printed(const char* end, Lines& lines) {
        at_ = end;
        lines.any = lines.sameLine = true;
        lines.lineStart = false;
        lines.lineEnds = 0;
    }

    // Whether a node follows the comment that ends at `p` on its line. One look for all comments in a row.
    bool leadsNode(const char* p) {
        if (p <= lookedTo_) return nodeAhead_;
        Token token = next(p);
        while (token.kind == TokenKind::blank || token.kind == TokenKind::blockComment) token = next(token.end);
        lookedTo_ = token.begin;
        nodeAhead_ = !endsNode(token.kind) && token.kind != TokenKind::continuation;
        return nodeAhead_;
    }

    void node(const Token& first, std::string_view blanks, Lines& lines) {
        const std::string_view name = nameOf(first);
        const bool table = name == "-" || (!lines.opened && !name.empty());
        const bool joins = lines.sameLine && lines.semicolon && lines.plain && table && name == lines.name;
        at_ = first.begin;
        if (!joins || !joinRow(blanks, lines)) {
            if (lines.sameLine && lines.leading)
                print(blanks.empty() ? " " : blanks);
            else
                startLine(lines, lines.lineStart ? columnsOf(blanks) : kElsewhere);
            lines.plain = printNode(lines.depth, true);
        }
        lines.name = name;
        lines.semicolon = lines.leading = false;
        printed(at_, lines);
    }

    // Nodes of one name that stand on a line are a row of a table and stay together, but for those of a block that
    // stood on one line itself: as many of them as fit into a line.
    bool joinRow(std::string_view blanks, const Lines& lines) {
        const std::size_t had = out_.size();
        const char* const begin = at_;
        print(";");
        print(blanks.empty() ? " " : blanks);
        const std::size_t line = lineBegin_;
        const bool plain = printNode(lines.depth, false);
        if (plain && line == lineBegin_ && (!lines.opened || !tooWide())) return true;
        out_.resize(had);
        lineBegin_ = line;
        at_ = begin;
        return false;
    }

    // As it will be printed; empty if something else stands before it.
    static std::string_view nameOf(const Token& first) {
        if (first.kind == TokenKind::word) return first.text();
        return first.kind == TokenKind::text ? withoutQuotes(first) : std::string_view{};
    }

    // From the first token to the last one before the node's end. Whether it stands on one line, without a block; where
    // it may have none, no more than that is printed.
    bool printNode(std::size_t depth, bool mayHaveBlock) {
        Head head;
        bool dashed = false; // behind `/-`, where lines may end
        bool plain = true;
        const std::size_t line = lineBegin_;
        for (;;) {
            const char* const gap = at_;
            const Token token = skipGap(dashed);
            if (endsNode(token.kind)) {
                at_ = gap;
                return plain && line == lineBegin_;
            }
            printGap(gap, token.begin);
            at_ = token.begin;
            if (token.kind == TokenKind::open) {
                if (!mayHaveBlock) return false;
                if (!dashed) needBlank();
                const LineColumns columns = line_;
                block(depth);
                line_ = columns;
                plain = false;
            } else {
                printToken(token, head);
                at_ = token.end;
            }
            dashed = token.kind == TokenKind::slashdash;
        }
    }

    // The next token of the node behind `at_`.
    Token skipGap(bool dashed) {
        bool continued = false;
        for (Token token = next(at_);; token = next(token.end)) {
            const bool inside = continued || dashed;
            if (token.kind == TokenKind::continuation)
                continued = true;
            else if (token.kind == TokenKind::lineEnd && inside)
                continued = false;
            else if (token.kind != TokenKind::blank && token.kind != TokenKind::blockComment &&
                     !(token.kind == TokenKind::lineComment && inside))
                return token;
        }
    }

    // What stands between two tokens of a node, which may be several lines. Those that are indented more than the node
    // stay so by as much; the others go one level behind it.
    void printGap(const char* p, const char* end) {
        std::string_view blanks;
        bool lineStart = false;
        const auto printBlanks = [&] {
            if (!lineStart) return print(blanks);
            const int more = columnsOf(blanks) - line_.was;
            indent(static_cast<std::size_t>(line_.is) + (more > 0 ? static_cast<std::size_t>(more) : kIndent));
        };
        while (p < end) {
            const Token token = next(p);
            p = token.end;
            if (token.kind == TokenKind::blank) {
                blanks = token.text();
                continue;
            }
            if (token.kind == TokenKind::lineEnd) {
                if (!lineStart) endLine();
                lineStart = true;
            } else {
                printBlanks();
                lineStart = false;
                if (token.kind == TokenKind::lineComment)
                    printLineComment(token.text());
                else if (token.kind == TokenKind::blockComment)
                    printBlockComment(token.text());
                else
                    print(token.text());
            }
            blanks = {};
        }
        printBlanks();
    }

    // Blocks -------------------------------------------------------------------------------------------------------

    // At `{`.
    void block(std::size_t depth) {
        Wide inside;
        if (inlineBlock(inside)) return;
        oneBlank();
        print(take(1));
        const bool mayBeAligned = mayBeAligned_;
        mayBeAligned_ = inside.mayBeAligned;
        nodes(depth + 1, true, inside.tooLong);
        mayBeAligned_ = mayBeAligned;
        endLine();
        indent(kIndent * depth);
        print(take(1));
    }

    // Of a block that is not printed on one line.
    struct Wide {
        bool mayBeAligned = true; // blocks inside of it
        bool tooLong = false;     // it stood on one line
    };

    // Prints a block that stands on one line of the source and fits into one, or was aligned by hand in it: two
    // blanks in a row. False, with nothing printed, if it does not.
    bool inlineBlock(Wide& inside) {
        const std::size_t had = out_.size();
        const char* const end = printInline(inside);
        if (end != nullptr) {
            at_ = end;
            return true;
        }
        out_.resize(had);
        return false;
    }

    const char* printInline(Wide& inside) {
        std::vector<Head> heads;
        std::string_view blanks;
        TokenKind last = TokenKind::slashdash; // needs no space behind it
        bool wide = false;
        inside = {mayBeAligned_, false};
        for (const char* p = at_;;) {
            const Token token = next(p);
            p = token.end;
            if (token.kind == TokenKind::blank) {
                blanks = token.text();
                continue;
            }
            if (breaksLine(token)) return nullptr;
            if (token.kind == TokenKind::semicolon && closesAt(p)) {
                blanks = {};
                continue;
            }
            wide |= columnsOf(blanks) > 1;
            const bool apart = last == TokenKind::semicolon ||
                               (last == TokenKind::open && token.kind != TokenKind::close) ||
                               (last != TokenKind::open && token.kind == TokenKind::close) ||
                               (last != TokenKind::slashdash && token.kind == TokenKind::open);
            print(blanks.empty() && apart ? " " : blanks);
            blanks = {};
            printInlineToken(token, heads);
            const bool closed = heads.empty();
            if (closed && (wide || last == TokenKind::open || !tooWide())) return p;
            if (closed || (!wide && !mayBeAligned_ && token.kind != TokenKind::open && tooWide())) {
                inside = {false, true};
                return nullptr;
            }
            last = token.kind;
        }
    }

    static bool breaksLine(const Token& token) {
        if (token.kind == TokenKind::text || token.kind == TokenKind::blockComment)
            for (const char* p = token.begin; p < token.end; ++p)
                if (newlineLength(p, token.end) > 0) return true;
        return token.kind == TokenKind::lineEnd || token.kind == TokenKind::lineComment ||
               token.kind == TokenKind::continuation || token.kind == TokenKind::end;
    }

    bool closesAt(const char* p) {
        Token token = next(p);
        if (token.kind == TokenKind::blank) token = next(token.end);
        return token.kind == TokenKind::close;
    }

    void printInlineToken(const Token& token, std::vector<Head>& heads) {
        if (token.kind == TokenKind::close) heads.pop_back();
        if (token.kind == TokenKind::semicolon) heads.back() = {};
        if (token.kind == TokenKind::open) heads.emplace_back();
        if (token.kind == TokenKind::open || token.kind == TokenKind::close || isComment(token.kind))
            print(token.text());
        else
            printToken(token, heads.back());
    }

    const SourceText text_;
    Diagnostics ignored_; // there are none
    SyntaxErrors errors_;
    schema::Document scratch_; // of decoded texts
    const char* at_;           // next character to read
    std::string out_;
    std::string_view lineEnd_ = "\n";
    std::size_t first_ = 0;     // of out_, where the first line begins
    std::size_t lineBegin_ = 0; // of out_, where the last line begins
    LineColumns line_;          // of the last line of out_
    bool mayBeAligned_ = true;  // not in a block that was known to hold nothing aligned
    const char* lookedTo_ = nullptr;
    bool nodeAhead_ = false;
};

} // namespace

} // namespace parser

std::string layOut(std::string_view text) {
    const std::string copy(text); // ends with a NUL
    return parser::Layout(copy).write();
}

std::string formatted(std::string_view text) {
    SourceMap sources;
    Diagnostics none;
    const auto document = parse(sources, sources.add("text", std::string(text)), {}, none);
    return layOut(schema::withCanonicalUnits(text, *document));
}

std::string withEdition(std::string_view text) {
    using parser::TokenKind;
    const std::string copy(text); // ends with a NUL
    const char* const begin = copy.data();
    Diagnostics none;
    parser::SyntaxErrors errors({FileId::none, begin, begin + copy.size()}, none);
    schema::Document scratch;
    const char* place = begin + (text.starts_with("\xef\xbb\xbf") ? 3 : 0);
    bool any = false;    // a comment came, or `/- kdl-version 2`, which must be first
    bool marker = false; // in the latter
    int lineEnds = 0;    // since then
    for (auto token = nextToken(place, errors, scratch); !(any && lineEnds > 1);
         token = nextToken(token.end, errors, scratch)) {
        if (token.kind == TokenKind::slashdash && !any) marker = true;
        if (token.kind == TokenKind::lineEnd) {
            if (any && lineEnds == 0) place = token.end;
            ++lineEnds;
            marker = false;
        } else if (token.kind == TokenKind::lineComment || token.kind == TokenKind::blockComment || marker) {
            any = true;
            lineEnds = 0;
        } else if (token.kind != TokenKind::blank) {
            break;
        }
    }
    const std::size_t at = static_cast<std::size_t>(place - begin);
    const std::size_t newline = copy.find('\n');
    const std::string lineEnd =
        newline != std::string::npos && newline > 0 && copy[newline - 1] == '\r' ? "\r\n" : "\n";
    return copy.substr(0, at) + "scene 1" + lineEnd + (lineEnds > 1 && any ? "" : lineEnd) + copy.substr(at);
}

namespace {

bool sameNumber(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

bool sameValue(const schema::Value& a, const schema::Value& b) {
    if (a.kind == schema::ValueKind::number && b.kind == a.kind) return sameNumber(a.number, b.number);
    return a.kind == b.kind && a.text == b.text && a.boolean == b.boolean;
}

std::vector<double> allOf(const schema::PackedNumbers& numbers) {
    std::vector<double> all;
    all.reserve(numbers.size());
    for (const double number : numbers) all.push_back(number);
    return all;
}

// Rows of numbers may be packed in one of them and not in the other, by what stands between the numbers.
bool sameValues(const schema::Node& a, const schema::Node& b) {
    const std::size_t count = a.valueCount();
    if (count != b.valueCount()) return false;
    if (a.allNumbers() && b.allNumbers()) return std::ranges::equal(allOf(a.numbers()), allOf(b.numbers()), sameNumber);
    for (std::size_t i = 0; i < count; ++i)
        if (!sameValue(a.value(i), b.value(i))) return false;
    return true;
}

bool sameKey(const schema::Key& a, const schema::Key& b) { return a.name == b.name && sameValue(a.value, b.value); }

// As deep as the reader of a text goes.
bool sameNodes(const schema::NodeRange& a, const schema::NodeRange& b) {
    auto p = a.begin(), q = b.begin();
    for (; p != a.end() && q != b.end(); ++p, ++q) {
        const schema::Node m = *p, n = *q;
        if (m.name() != n.name() || m.hasBlock() != n.hasBlock() || !sameValues(m, n) ||
            !std::ranges::equal(m.keys(), n.keys(), sameKey) || !sameNodes(m.children(), n.children()))
            return false;
    }
    return p == a.end() && q == b.end();
}

} // namespace

bool sameMeaning(const schema::Document& a, const schema::Document& b) {
    const auto sameParameter = [](const auto& p, const auto& q) {
        return p.name == q.name && p.doc == q.doc && std::ranges::equal(p.written, q.written, sameValue);
    };
    return std::ranges::equal(a.parameters, b.parameters, sameParameter) && sameNodes(a.roots(), b.roots());
}

} // namespace abbe

#include "parser/brace_plan.h"

#include "parser/characters.h"
#include "parser/source_text.h"
#include "parser/tokens.h"
#include "schema/type.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <string_view>
#include <vector>

namespace abbe::parser {

namespace {

// A brace or bracket outside of texts and comments.
struct BraceToken {
    const char* at;
    char kind; // { } ( ) [ ]
};

// A line that holds more than comments and does not begin inside of a text or comment.
struct BraceLine {
    const char* first = nullptr;         // its first character behind the indentation
    const char* last = nullptr;          // its last one before a comment
    std::ptrdiff_t indent = 0;           // characters before `first`
    std::vector<BraceToken> tokens = {}; // from left to right
    bool continued = false;              // ends in `\`

    std::string_view word() const; // the bare word that it begins with; empty if it does not
    std::string_view text() const { return between(first, last + 1); }
    bool ends(char c) const { return *last == c; }
    bool is(char c) const { return first == last && *first == c; } // nothing else stands in it
    // How many of its own opening braces stay open, and how many closing ones close an earlier line's.
    std::ptrdiff_t opened() const;
    std::ptrdiff_t closed() const;
};

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

bool isKindWord(std::string_view word) { return word == "param" || schema::findKind(word).has_value(); }

// What holds definitions: there a kind may begin any line.
bool isContainerWord(std::string_view word) { return word == "group" || word == "object"; }

// Kinds that are no property of a type either.
bool beginsDefinition(std::string_view word) {
    return isKindWord(word) && word != "material" && word != "texture" && word != "medium" && word != "phase" &&
           word != "spectrum";
}

class BracePlanner {
  public:
    explicit BracePlanner(const SourceText& text) : text_(text), lines_(braceLines(text)) {
        plan_.text.assign(text.begin, text.end);
    }

    std::optional<BracePlan> plan() {
        if (countBrackets() > kMost) return std::nullopt;
        replaceBrackets();
        unswap();
        const std::ptrdiff_t surplus = countSurplus();
        if (std::abs(surplus) > kMost) return std::nullopt;
        if (surplus < 0) closeMissing(-surplus);
        if (surplus > 0) dropSurplus(surplus - openMissing(surplus));
        if (plan_.found.all().empty()) return std::nullopt;
        std::ranges::stable_sort(plan_.implied, {}, &ImpliedBrace::before);
        return std::move(plan_);
    }

  private:
    static constexpr std::ptrdiff_t kMost = 100; // mistakes of one kind; more is no scene, and would take long

    struct Open {
        const BraceLine* line;
        const char* brace; // null: implied
    };

    Diagnostic& error(const char* code, const char* from, const char* to, std::string message, std::string label) {
        return plan_.found.error(code, text_.span(from, to), std::move(message), std::move(label));
    }
    Diagnostic& errorAt(const char* code, const char* at, std::string message, std::string label) {
        return error(code, at, at + 1, std::move(message), std::move(label));
    }
    void relate(Diagnostic& d, const char* at, std::string text) const {
        d.related.push_back({text_.span(at, at + 1), std::move(text)});
    }
    void replaceFix(Diagnostic& d, const char* at, std::string text) const {
        d.fixes.push_back({text_.span(at, at + 1), std::move(text)});
    }

    // Makes the token another character, in the lines and in the text that is read instead.
    void replace(BraceToken& token, char c) {
        token.kind = c;
        plan_.text[static_cast<std::size_t>(token.at - text_.begin)] = c;
    }

    // Brackets ---------------------------------------------------------------------------------------------------

    // `camera (` at the end of a line, or `camera (from …)` in one: parentheses and brackets as braces.
    void replaceBrackets() {
        for (std::size_t i = 0; i < lines_.size(); ++i)
            if (BraceToken* const open = bracketOfBlock(lines_[i])) replaceBracketPair(i, *open);
        int depth = 0;
        for (BraceLine& line : lines_) {
            const bool lone = depth > 0 && (line.is(')') || line.is(']')) && line.tokens[0].kind != '}';
            if (lone) {
                Diagnostic& d = errorAt("E0126", line.first, "a block ends with a brace", "write `}`");
                replaceFix(d, line.first, "}");
                replace(line.tokens[0], '}');
            }
            for (const BraceToken& t : line.tokens) depth += t.kind == '{' ? 1 : t.kind == '}' ? -1 : 0;
        }
    }

    std::ptrdiff_t countBrackets() {
        return std::ranges::count_if(lines_, [](BraceLine& line) { return bracketOfBlock(line) != nullptr; });
    }

    static BraceToken* bracketOfBlock(BraceLine& line) {
        if (line.word().empty() || line.tokens.empty()) return nullptr;
        BraceToken& first = line.tokens.front();
        BraceToken& last = line.tokens.back();
        const auto isOpening = [](const BraceToken& t) { return t.kind == '(' || t.kind == '['; };
        if (isOpening(last) && last.at == line.last) return &last;
        const char* inside = first.at + 1;
        while (*inside == ' ') ++inside;
        const bool holdsWords = (*inside | 0x20) >= 'a' && (*inside | 0x20) <= 'z' && // `from 0 1 3`
                                std::find(inside, last.at, ' ') < last.at;
        const bool whole = (last.kind == ')' || last.kind == ']') && last.at == line.last;
        return isOpening(first) && whole && holdsWords && isKindWord(line.word()) ? &first : nullptr;
    }

    // The bracket or brace that closes what `open` in line i opens.
    BraceToken* closingOf(std::size_t i, const BraceToken& open) {
        int depth = 0;
        for (std::size_t j = i; j < lines_.size(); ++j)
            for (BraceToken& t : lines_[j].tokens) {
                if (j == i && t.at < open.at) continue;
                const bool opens = t.kind == '{' || t.kind == '(' || t.kind == '[';
                depth += opens ? 1 : -1;
                if (depth == 0) return &t;
            }
        return nullptr;
    }

    void replaceBracketPair(std::size_t i, BraceToken& open) {
        BraceToken* const close = closingOf(i, open);
        if (close == nullptr) return;
        const char* const name = open.kind == '(' ? "parentheses" : "brackets";
        Diagnostic& d =
            errorAt("E0126", open.at, fmt::format("a block stands in braces, not in {}", name), "write `{`");
        const bool spaced = open.at > text_.begin && has(open.at[-1], kBlank);
        replaceFix(d, open.at, spaced ? "{" : " {");
        replace(open, '{');
        if (close->kind == '}') return;
        relate(d, close->at, "and `}` here");
        replaceFix(d, close->at, "}");
        replace(*close, '}');
    }

    // Swapped ----------------------------------------------------------------------------------------------------

    // `camera }`, more indented lines, and `{`.
    void unswap() {
        std::ptrdiff_t swapped = 0;
        for (std::size_t i = 0; i + 1 < lines_.size() && swapped < kMost; ++i) {
            BraceLine& line = lines_[i];
            const bool closes = line.closed() == 1 && line.tokens.size() == 1 && line.ends('}') && !line.word().empty();
            if (!closes || lines_[i + 1].indent <= line.indent) continue;
            ++swapped;
            Diagnostic& d = errorAt("E0111", line.last, "this `}` closes nothing", "write `{`: it opens a block");
            replaceFix(d, line.last, "{");
            replace(line.tokens[0], '{');
            if (BraceToken* const closing = wrongClosing(i + 1, line.indent)) {
                relate(d, closing->at, "and `}` here");
                replaceFix(d, closing->at, "}");
                replace(*closing, '}');
            }
        }
        std::ptrdiff_t depth = 0;
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            BraceLine& line = lines_[i];
            const bool lone = depth > 0 && line.is('{') && line.tokens[0].kind == '{';
            if (lone && lines_[i - 1].indent > line.indent) {
                Diagnostic& d =
                    errorAt("E0121", line.first, "a block needs a name before it", "write `}`: it ends a block");
                replaceFix(d, line.first, "}");
                replace(line.tokens[0], '}');
            }
            depth += line.opened() - line.closed();
        }
    }

    // The `{` alone in its line behind the lines from i on, which are indented by more than `indent`.
    BraceToken* wrongClosing(std::size_t i, std::ptrdiff_t indent) {
        while (i < lines_.size() && lines_[i].indent > indent) ++i;
        return i < lines_.size() && lines_[i].is('{') ? &lines_[i].tokens[0] : nullptr;
    }

    // Closing braces without an opening one, less opening ones without a closing one.
    std::ptrdiff_t countSurplus() const {
        std::ptrdiff_t surplus = 0;
        for (const BraceLine& line : lines_)
            for (const BraceToken& t : line.tokens) surplus += t.kind == '}' ? 1 : t.kind == '{' ? -1 : 0;
        return surplus;
    }

    // Missing closing braces -------------------------------------------------------------------------------------

    // Whether the line stands outside of the block, although nothing closed it. In a block that is not indented at all
    // only what is no property is outside.
    bool isOutside(const BraceLine& line, const Open& block) const {
        if (line.indent > block.line->indent) return false;
        if (*line.first == '}' && line.indent == block.line->indent) return false;
        const BraceLine& next = block.line[1]; // `line` at the latest
        const bool flat = block.line->ends('{') && *next.first != '}' && next.indent <= block.line->indent;
        if (!flat) return true;
        return !isContainerWord(block.line->word()) && beginsDefinition(line.word());
    }

    void closeMissing(std::ptrdiff_t missing) {
        std::vector<Open> open;
        for (const BraceLine& line : lines_) {
            while (missing > 0 && !open.empty() && isOutside(line, open.back())) {
                reportUnclosed(open.back(), &line);
                open.pop_back();
                --missing;
            }
            for (const BraceToken& t : line.tokens) {
                if (t.kind == '{') open.push_back({&line, t.at});
                if (t.kind == '}' && !open.empty()) open.pop_back();
            }
        }
        for (const Open& block : open)
            if (missing-- > 0) reportUnclosed(block, nullptr);
    }

    void reportUnclosed(const Open& block, const BraceLine* outside) {
        Diagnostic& d = errorAt("E0110", block.brace, "this block is not closed", "no matching `}`");
        if (outside != nullptr) relate(d, outside->first, "a `}` is missing before this line");
        plan_.implied.push_back({text_.offset(outside != nullptr ? outside->first : text_.end), false});
    }

    // Missing opening braces -------------------------------------------------------------------------------------

    // Lines whose followers are indented although they open nothing; at most `most` of them. Returns how many.
    std::ptrdiff_t openMissing(std::ptrdiff_t most) {
        std::ptrdiff_t count = 0, depth = 0;
        for (std::size_t i = 0; i < lines_.size() && count < most; ++i) {
            BraceLine& line = lines_[i];
            if (depth == 0 && isClosedOnly(line)) {
                reportUnopened(line, line.first, line.last + 1, "somewhere in this line");
                for (const char* p = line.first; p <= line.last; ++p) // what is in the block cannot be told
                    plan_.text[static_cast<std::size_t>(p - text_.begin)] = ' ';
                line.tokens.clear();
                ++count;
            } else if (i + 1 < lines_.size() && opensInvisibly(line, lines_[i + 1])) {
                Diagnostic& d = reportUnopened(line, line.last + 1, line.last + 1, "write ` {` here");
                d.fixes.push_back({d.span, " {"});
                plan_.implied.push_back({text_.offset(lines_[i + 1].first), true});
                ++depth;
                ++count;
            }
            depth += line.opened() - line.closed();
        }
        return count;
    }

    static bool opensInvisibly(const BraceLine& line, const BraceLine& next) {
        return next.indent > line.indent && line.opened() == 0 && !line.ends('}') && !line.continued &&
               !line.word().empty() && *next.first != '{' && *next.first != '-';
    }

    // `camera from 0 1 3; fov 40 deg }`
    static bool isClosedOnly(const BraceLine& line) {
        return line.opened() == 0 && line.closed() == 1 && line.ends('}') && isKindWord(line.word());
    }

    Diagnostic& reportUnopened(const BraceLine& line, const char* from, const char* to, std::string label) {
        return error("E0127", from, to, fmt::format("the block of `{}` has no `{{`", line.word()), std::move(label));
    }

    // Superfluous closing braces -----------------------------------------------------------------------------------

    // Those that close a block of an outer line, although they or what follows them are indented like inner ones.
    void dropSurplus(std::ptrdiff_t surplus) {
        std::vector<Open> open;
        const char* lastClosing = nullptr; // of the last top-level block
        auto implied = plan_.implied.begin();
        for (std::size_t i = 0; i < lines_.size() && surplus > 0; ++i) {
            BraceLine& line = lines_[i];
            if (implied != plan_.implied.end() && implied->before == text_.offset(line.first)) {
                open.push_back({&lines_[i - 1], nullptr});
                ++implied;
            }
            for (BraceToken& t : line.tokens) {
                if (t.kind == '{') open.push_back({&line, t.at});
                if (t.kind != '}') continue;
                if (surplus > 0 && (open.empty() || closesEarly(t, i, *open.back().line))) {
                    reportSuperfluous(t, open.empty() ? nullptr : open.back().line, lastClosing);
                    --surplus;
                } else if (!open.empty()) {
                    open.pop_back();
                    if (open.empty()) lastClosing = t.at;
                }
            }
        }
    }

    bool closesEarly(const BraceToken& t, std::size_t i, const BraceLine& opener) const {
        const BraceLine& line = lines_[i];
        if (&line == &opener) return false;
        if (t.at == line.first) return line.indent > opener.indent;
        return i + 1 < lines_.size() && lines_[i + 1].indent > opener.indent;
    }

    // `outer`: the line whose block it would close; null where no block is open.
    void reportSuperfluous(BraceToken& t, const BraceLine* outer, const char* lastClosing) {
        if (outer != nullptr) {
            Diagnostic& d = errorAt("E0111", t.at, "this `}` is one too many", "it is indented like an inner line");
            relate(d, outer->first, "but would close the block that begins here");
        } else {
            Diagnostic& d = errorAt("E0111", t.at, "this `}` closes nothing", "no block is open");
            if (lastClosing != nullptr) relate(d, lastClosing, "the last open block ends here");
        }
        replace(t, ' ');
        const char* next = t.at + 1;
        while (*next == ' ' || *next == '\t') ++next;
        if (*next == ';') plan_.text[static_cast<std::size_t>(next - text_.begin)] = ' '; // would end nothing
    }

    const SourceText& text_;
    std::vector<BraceLine> lines_;
    BracePlan plan_;
};

} // namespace

std::optional<BracePlan> planBraces(const SourceText& text) { return BracePlanner(text).plan(); }

} // namespace abbe::parser

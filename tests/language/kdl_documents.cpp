#include "kdl_documents.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace language_test {

namespace {

// SplitMix64 [Steele2014].
class Chance {
  public:
    explicit Chance(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        return z ^ z >> 31;
    }
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(next() % n); }
    bool oneIn(std::size_t n) { return below(n) == 0; }
    std::string_view from(std::span<const std::string_view> list) { return list[below(list.size())]; }

  private:
    std::uint64_t state_;
};

constexpr auto kLineEnds = std::to_array<std::string_view>(
    {"\n", "\n", "\n", "\n", "\n", "\n", "\r\n", "\r", "\u0085", "\v", "\f", "\u2028", "\u2029"});
constexpr auto kBlanks = std::to_array<std::string_view>(
    {" ", " ", " ", " ", "  ", "\t", "\u00a0", "\u1680", "\u2003", "\u200a", "\u202f", "\u205f", "\u3000"});
constexpr auto kWords = std::to_array<std::string_view>({
    "a",          "b",    "camera", "look-at", "-",
    "--",         "+",    ".",      "-.",      "..1",
    "+.x",        "-a",   "_",      "inf1",    "nano",
    "truely",     "+inf", "-nan",   "a.exr",   "a'b",
    "<x>",        "~!@%", "a|b",    "\u6728",  "gr\u00f6\u00dfe",
    "\U0001f600", "e10",  "x0",     "r",       "null-",
    "\u2460",     "a+b",  "*",      "^",       "k:v",
    "True",       "?",    "&",
});
constexpr auto kNumbers = std::to_array<std::string_view>({"0",
                                                           "1",
                                                           "-1",
                                                           "+1",
                                                           "007",
                                                           "1_000",
                                                           "1__0_",
                                                           "1.5",
                                                           "-1.5e3",
                                                           "1.0E+10",
                                                           "2e-3",
                                                           "0x1F",
                                                           "-0xa_b",
                                                           "+0x0",
                                                           "0o17",
                                                           "0b1_0",
                                                           "#inf",
                                                           "#-inf",
                                                           "#nan",
                                                           "0.1_5",
                                                           "1e1_0",
                                                           "3.14159265358979",
                                                           "12345678901234567890",
                                                           "1e-400"});
constexpr auto kKeywords = std::to_array<std::string_view>({"#true", "#false", "#null"});
constexpr auto kCharacters =
    std::to_array<std::string_view>({"a", "b", "c", " ",  " ",  "\t", "/",  "{",      "}",      ";",          "#", "=",
                                     "(", "'", ",", "//", "/*", "*/", "/-", "\u00e9", "\u3000", "\U0001f600", "0"});
constexpr auto kEscapes =
    std::to_array<std::string_view>({"\\n", "\\r", "\\t", "\\\\", "\\\"", "\\b", "\\f", "\\s", "\\u{0}", "\\u{1F600}",
                                     "\\u{00e9}", "\\u{10FFFF}", "\\   ", "\\\n  ", "\\\r\n", "\\ \n \t\n"});
// What changes put into a document.
constexpr auto kChanges = std::to_array<std::string_view>(
    {"{",      "}",    ";",      ";;",   "=",      "(",    ")",      "(t)",       "\"",
     "\"\"\"", "#",    "#\"",    "\"#",  "\\",     "/",    "/-",     "/*",        "*/",
     "//",     ",",    "'",      " ",    "\n",     "\r",   "\u0085", "\ufeff",    "\u200e",
     "\x01",   "\x7f", "true",   "null", "-inf",   "#nan", "#no",    ".5",        "1.",
     "1a",     "0x",   "0b2",    "1e",   "_",      "[",    "]",      "\\u{D800}", "\\u{110000}",
     "\\/",    "\\x",  "\u3000", "/-\n", "\\\n",   "/-{}", "k=",     "\"\"",      "##\"a\"#b\"##",
     "1e999",  "$x",   "\u201c", "- 1",  "\u2066", "\\ c"});

class Writer {
  public:
    explicit Writer(Chance& chance) : chance_(chance), tight_(chance.oneIn(4)), plain_(!chance.oneIn(4)) {}

    std::string document() {
        if (chance_.oneIn(20)) out_ += "\ufeff";
        if (chance_.oneIn(30)) out_ += "/- kdl-version 2\n";
        nodes(0, 1 + chance_.below(4));
        return std::move(out_);
    }

  private:
    std::string_view lineEnd() { return plain_ ? "\n" : chance_.from(kLineEnds); }
    std::string_view blank() { return plain_ ? chance_.oneIn(8) ? "\t" : " " : chance_.from(kBlanks); }
    void put(std::string_view text) {
        if (out_.ends_with('\r') && text.starts_with('\n')) out_ += '\v'; // these are two line ends
        out_ += text;
    }

    void comment() {
        put("/*");
        for (std::size_t i = chance_.below(3); i > 0; --i) {
            if (chance_.oneIn(4))
                comment();
            else
                put(chance_.oneIn(6) ? lineEnd() : chance_.oneIn(4) ? "** " : " c ");
        }
        put("*/");
    }
    void space() { // at least one
        do {
            if (chance_.oneIn(14))
                comment();
            else if (chance_.oneIn(14))
                continuation();
            else
                put(blank());
        } while (chance_.oneIn(6));
    }
    void perhapsSpace() {
        if (chance_.oneIn(4)) space();
    }
    // Before `{` and `/-`.
    void blockSpace() {
        if (!tight_ || chance_.oneIn(4)) space();
    }
    void continuation() {
        put("\\");
        if (chance_.oneIn(3)) put(" ");
        if (chance_.oneIn(8)) comment();
        if (chance_.oneIn(4)) put("// c");
        put(lineEnd());
    }
    void lineSpace() { // between nodes, and behind `/-`
        while (chance_.oneIn(4)) {
            if (chance_.oneIn(3))
                put(lineEnd());
            else if (chance_.oneIn(4))
                lineComment();
            else
                space();
        }
    }
    void lineComment() {
        put(chance_.oneIn(4) ? "//" : "// c { \"");
        put(lineEnd());
    }

    void quoted() {
        put("\"");
        for (std::size_t i = chance_.below(5); i > 0; --i)
            put(chance_.oneIn(3) ? chance_.from(kEscapes) : chance_.from(kCharacters));
        put("\"");
    }
    void raw() {
        const std::string hashes(1 + chance_.below(3), '#');
        put(hashes + "\"");
        put(chance_.from(kCharacters)); // so that it is no text of several lines
        for (std::size_t i = chance_.below(4); i > 0; --i)
            put(chance_.oneIn(4) ? "\\n" : chance_.oneIn(4) ? "\" " : chance_.from(kCharacters));
        put(" \"" + hashes);
    }
    void severalLines() {
        const std::string hashes(chance_.oneIn(3) ? 1 + chance_.below(2) : 0, '#');
        const std::string indent(chance_.below(4), chance_.oneIn(4) ? '\t' : ' ');
        put(hashes + "\"\"\"");
        put(lineEnd());
        for (std::size_t lines = chance_.below(4); lines > 0; --lines) {
            if (!chance_.oneIn(5)) {
                put(indent);
                for (std::size_t i = chance_.below(4); i > 0; --i) {
                    const bool escape = hashes.empty() && chance_.oneIn(4);
                    put(escape             ? chance_.from(std::span(kEscapes).first(12))
                        : chance_.oneIn(6) ? "\"x"
                                           : chance_.from(kCharacters));
                }
            } else if (chance_.oneIn(2)) {
                put(chance_.oneIn(2) ? " " : "\t\t");
            }
            put(lineEnd());
        }
        put(indent);
        if (hashes.empty() && chance_.oneIn(8)) put("\\  ");
        put("\"\"\"" + hashes);
    }
    void string() {
        switch (chance_.below(8)) {
        case 0:
        case 1:
            return quoted();
        case 2:
            return raw();
        case 3:
            return severalLines();
        default:
            return put(chance_.from(kWords));
        }
    }
    void value() {
        switch (chance_.below(8)) {
        case 0:
            return put(chance_.from(kKeywords));
        case 1:
        case 2:
        case 3:
            return put(chance_.from(kNumbers));
        default:
            return string();
        }
    }
    void type() {
        if (!chance_.oneIn(8)) return;
        put("(");
        perhapsSpace();
        string();
        perhapsSpace();
        put(")");
        perhapsSpace();
    }
    void entry() {
        if (chance_.oneIn(4)) {
            string();
            perhapsSpace();
            put("=");
            perhapsSpace();
        }
        type();
        value();
    }
    void slashdash() {
        put("/-");
        lineSpace();
    }

    void node(std::size_t depth) {
        if (chance_.oneIn(12)) slashdash();
        type();
        string();
        for (std::size_t i = chance_.below(4); i > 0; --i) {
            if (chance_.oneIn(8)) {
                blockSpace();
                slashdash();
            } else {
                space();
            }
            entry();
        }
        while (chance_.oneIn(16)) blockSpace(), slashdash(), block(depth);
        if (depth < 3 && chance_.oneIn(3)) {
            blockSpace();
            block(depth);
        }
        while (chance_.oneIn(16)) blockSpace(), slashdash(), block(depth);
        perhapsSpace();
    }
    void block(std::size_t depth) {
        put("{");
        nodes(depth + 1, chance_.below(3));
        if (chance_.oneIn(3)) {
            lineSpace();
            node(depth + 1);
        }
        put("}");
    }
    void nodes(std::size_t depth, std::size_t count) {
        for (; count > 0; --count) {
            lineSpace();
            node(depth);
            if (chance_.oneIn(4))
                put(";");
            else if (chance_.oneIn(6))
                lineComment();
            else
                put(lineEnd());
        }
        lineSpace();
    }

    Chance& chance_;
    // In most documents the rare things are left out, so that others show where implementations disagree.
    const bool tight_; // no space where none is needed before `{` and `/-`
    const bool plain_; // white space is spaces and tabs, lines end with LF
    std::string out_;
};

// Where the code points of a text begin, and its end.
std::vector<std::size_t> borders(std::string_view text) {
    std::vector<std::size_t> places;
    const char* const end = text.data() + text.size();
    for (const char* p = text.data(); p < end; p += std::max(abbe::decodeUtf8(p, end).length, 1u))
        places.push_back(static_cast<std::size_t>(p - text.data()));
    places.push_back(text.size());
    return places;
}

void change(std::string& text, Chance& chance) {
    const std::vector<std::size_t> places = borders(text);
    const auto any = [&] { return chance.below(places.size()); };
    const std::size_t first = any(), last = std::min(first + 1 + chance.below(4), places.size() - 1);
    const std::size_t at = places[first], length = places[std::max(last, first)] - at;
    switch (chance.below(6)) {
    case 0:
        text.erase(at, length);
        break;
    case 1: {
        const std::string piece = text.substr(at, length);
        text.insert(places[any()], piece);
        break;
    }
    case 2:
        text.replace(at, length, chance.from(kChanges));
        break;
    default:
        text.insert(at, chance.from(kChanges));
    }
}

} // namespace

std::string kdlDocument(std::uint32_t number) {
    Chance chance(number / 2);
    std::string text = Writer(chance).document();
    if (number % 2 == 1)
        for (std::size_t i = 1 + chance.below(3); i > 0; --i) change(text, chance);
    return text;
}

} // namespace language_test

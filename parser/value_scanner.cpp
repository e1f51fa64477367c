#include "parser/value_scanner.h"

#include "parser/characters.h"
#include "parser/number.h"
#include "parser/tokens.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>

namespace abbe::parser {

using schema::Value;
using schema::ValueKind;

bool startsNumber(const char* p) { return isDigit(*p) || ((*p == '-' || *p == '+') && isDigit(p[1])); }

bool startsPointNumber(const char* p) {
    if (*p == '-' || *p == '+') ++p;
    return *p == '.' && isDigit(p[1]);
}

bool isBareKeyword(std::string_view w) {
    return w == "true" || w == "false" || w == "null" || w == "inf" || w == "-inf" || w == "nan";
}

void ValueScanner::add(ValueKind kind, const char* from, const char* to, std::string_view text) {
    Value value;
    value.kind = kind;
    value.text = text;
    value.span = errors_.text().span(from, to);
    values_.push_back(value);
}

void ValueScanner::addNumber(const char* from, const char* to, double number) {
    add(ValueKind::number, from, to, between(from, to));
    values_.back().number = number;
}

void ValueScanner::add(bool boolean, const char* from, const char* to) {
    add(ValueKind::boolean, from, to, between(from, to));
    values_.back().boolean = boolean;
}

const char* ValueScanner::scan(const char* p, Place place) {
    values_.clear();
    lost_ = false;
    if (startsNumber(p) || startsPointNumber(p)) return scanNumber(p, place);
    if (*p == '#') return scanHash(p);
    if (*p == '"') {
        const TextLiteral literal = scanText(p, errors_, document_);
        add(ValueKind::string, p, literal.end, literal.text);
        lost_ = literal.lost;
        return literal.end;
    }
    if (*p == '(') return scanParentheses(p);
    return isWordCharacter(p, errors_.text().end) ? scanWord(p) : scanOther(p);
}

const char* ValueScanner::scanName(const char* p, std::string_view& name) {
    if (startsText(p)) {
        const TextLiteral literal = scanText(p, errors_, document_);
        name = literal.text;
        return literal.end;
    }
    const char* const end = wordEnd(p, errors_.text().end);
    if (end == p || startsNumber(p) || startsPointNumber(p)) return nullptr;
    name = between(p, end);
    if (isBareKeyword(name)) {
        Diagnostic& d = errors_.error("E0107", p, end, fmt::format("`{}` cannot be a name without quotes", name),
                                      fmt::format("write `\"{}\"`", name));
        errors_.fix(d, p, end, fmt::format("\"{}\"", name));
    }
    return end;
}

// Numbers ----------------------------------------------------------------------------------------------------------

const char* ValueScanner::scanNumber(const char* p, Place place) {
    const char* const end = wordEnd(p, errors_.text().end);
    if (*end == '/' && isDigit(end[1])) return scanFraction(p, end);
    if (*end == '=' && place == Place::argument) {
        errors_.error("E0113", p, end + 1, "the name of a key is a word, not a number",
                      fmt::format("write `\"{}\"=…` for a name that looks like a number", between(p, end)));
        lost_ = true;
        return end + 1;
    }
    const NumberResult number = parseNumber(between(p, end));
    if (number.error == NumberError::malformed) return scanMalformed(p, end, place);
    addNumber(p, end, number.value);
    if (number.error == NumberError::overflow) {
        errors_.error("E0118", p, end, "the number is too large", "the largest is about 1.8e308");
        values_.back().number = 1; // a harmless stand-in
        lost_ = true;
    }
    return end;
}

const char* ValueScanner::scanFraction(const char* p, const char* end) {
    const char* last = wordEnd(end + 1, errors_.text().end);
    Diagnostic& d = errors_.error("E0117", p, last, "a fraction is written in quotes",
                                  fmt::format("write `\"{}\"`", between(p, last)));
    errors_.fix(d, p, last, fmt::format("\"{}\"", between(p, last)));
    add(ValueKind::string, p, last, between(p, last));
    return last;
}

const char* ValueScanner::scanMalformed(const char* p, const char* end, Place place) {
    const std::string_view written = between(p, end);
    const NumberRepair repair = repairNumber(written);
    const bool fixable = !repair.replacement.empty() && (place == Place::argument || repair.second.empty());
    std::string label = repair.label;
    if (fixable && label.empty()) label = fmt::format("write `{}`", repair.replacement);
    if (!fixable && !repair.second.empty()) label = "a key takes one value";
    Diagnostic& d = errors_.error(repair.code, p, end, repair.message, std::move(label));
    if (fixable) errors_.fix(d, p, end, repair.replacement);
    lost_ = repair.lost;
    const NumberResult number = parseNumber(repair.first);
    const bool readable = number.error == NumberError::none;
    if (!readable) {
        add(ValueKind::word, p, end, written);
        return end;
    }
    const char* const split = p + repair.firstLength;
    addNumber(p, split, number.value);
    if (repair.second.empty()) return end;
    const NumberResult second = parseNumber(repair.second);
    if (second.error == NumberError::none)
        addNumber(end - repair.second.size(), end, second.value);
    else
        add(ValueKind::word, split, end, document_.intern(repair.second));
    return end;
}

// Words ------------------------------------------------------------------------------------------------------------

const char* ValueScanner::scanWord(const char* p) {
    constexpr std::string_view openQuote = "\xe2\x80\x9c"; // “
    if (*p == '\'' || std::strncmp(p, openQuote.data(), openQuote.size()) == 0) return scanForeignQuotes(p);
    const char* const end = wordEnd(p, errors_.text().end);
    if (!checkBareKeyword(p, end)) add(ValueKind::word, p, end, between(p, end));
    return end;
}

bool ValueScanner::checkBareKeyword(const char* p, const char* end) {
    const std::string_view word = between(p, end);
    if (!isBareKeyword(word)) return false;
    const bool boolean = word == "true" || word == "false";
    const std::string_view switchWord = word == "true" ? "on" : "off";
    const std::string replacement = boolean          ? std::string(switchWord)
                                    : word == "-inf" ? "#-inf"
                                                     : fmt::format("#{}", word);
    Diagnostic& d = errors_.error("E0107", p, end, fmt::format("the keyword `{}` is written `#{}`", word, word),
                                  boolean ? fmt::format("write `{}` or `#{}`", switchWord, word)
                                          : fmt::format("write `{}`", replacement));
    errors_.fix(d, p, end, replacement);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (boolean)
        add(word == "true", p, end);
    else if (word == "null")
        add(ValueKind::null, p, end, word);
    else
        addNumber(p, end, word == "inf" ? infinity : word == "-inf" ? -infinity : std::nan(""));
    return true;
}

// 'text' or “text”
const char* ValueScanner::scanForeignQuotes(const char* p) {
    constexpr std::string_view closing = "\xe2\x80\x9d"; // ”
    const bool single = *p == '\'';
    const char* const body = p + (single ? 1 : 3);
    const char* const line = findNearLineEnd(body, errors_.text().end);
    const std::string_view mark = single ? std::string_view{"'"} : closing;
    const char* const close = std::search(body, line, mark.begin(), mark.end());
    if (close == line) {
        const char* const end = wordEnd(p, errors_.text().end);
        errors_.error("E0114", p, end, "text is written in double quotes", "write `\"…\"`");
        add(ValueKind::string, p, end, between(body, std::max(body, end)));
        lost_ = true;
        return end;
    }
    const char* const end = close + mark.size();
    const bool plain = std::find_if(body, close, [](char c) { return c == '"' || c == '\\'; }) == close;
    Diagnostic& d = errors_.error("E0114", p, end, "text is written in double quotes",
                                  plain ? fmt::format("write `\"{}\"`", between(body, close)) : "write `\"…\"`");
    if (plain) errors_.fix(d, p, end, fmt::format("\"{}\"", between(body, close)));
    add(ValueKind::string, p, end, between(body, close));
    return end;
}

// Keywords ---------------------------------------------------------------------------------------------------------

const char* ValueScanner::scanHash(const char* p) {
    if (startsText(p)) {
        const TextLiteral literal = scanText(p, errors_, document_);
        add(ValueKind::string, p, literal.end, literal.text);
        lost_ = literal.lost;
        return literal.end;
    }
    const char* const end = wordEnd(p + 1, errors_.text().end);
    const std::string_view word = between(p + 1, end);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (word == "true" || word == "false")
        add(word == "true", p, end);
    else if (word == "null")
        add(ValueKind::null, p, end, between(p, end));
    else if (word == "inf")
        addNumber(p, end, infinity);
    else if (word == "-inf")
        addNumber(p, end, -infinity);
    else if (word == "nan")
        addNumber(p, end, std::nan(""));
    else
        return scanUnknownKeyword(p, end);
    return end;
}

const char* ValueScanner::scanUnknownKeyword(const char* p, const char* end) {
    if (end == p + 1) { // `# a comment`, `## a comment`
        const char* text = p;
        while (*text == '#') ++text;
        Diagnostic& d = errors_.error("E0108", p, text, "`#` does not begin a comment", "write `//`");
        errors_.fix(d, p, text, "//");
        return findLineEnd(text, errors_.text().end);
    }
    const std::string_view word = between(p, end);
    const bool hexadecimal =
        std::all_of(p + 1, end, [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
    lost_ = true;
    if (hexadecimal && (word.size() == 4 || word.size() == 7 || word.size() == 9)) {
        Diagnostic& d = errors_.error("E0125", p, end, "a colour in hexadecimal digits is a text",
                                      fmt::format("write `\"{}\"`", word));
        errors_.fix(d, p, end, fmt::format("\"{}\"", word));
        add(ValueKind::string, p, end, word);
        lost_ = false;
        return end;
    }
    Diagnostic& d = errors_.error("E0125", p, end, fmt::format("`{}` is not a keyword", word), "unknown keyword");
    d.help = "the keywords are `#true`, `#false`, `#null`, `#inf`, `#-inf` and `#nan`; a comment begins with `//`";
    return end;
}

// Mistakes ---------------------------------------------------------------------------------------------------------

// `rgb(0.8, 0.2, 0.1)`: everything up to the closing parenthesis on the line is one mistake.
const char* ValueScanner::scanParentheses(const char* p) {
    const char* const line = findNearLineEnd(p, errors_.text().end);
    const char* const close =
        std::find_if(p, line, [](char c) { return c == ')' || c == '{' || c == '}' || c == ';'; });
    const char* const end = *close == ')' ? close + 1 : p + 1;
    errors_.error("E0123", p, end, "parentheses have no meaning here",
                  "write the values with spaces: `rgb 0.8 0.2 0.1`");
    lost_ = true;
    return end;
}

const char* ValueScanner::scanOther(const char* p) {
    const std::uint32_t length = std::max(decodeUtf8(p, errors_.text().end).length, 1u);
    const std::string_view character = between(p, p + length);
    lost_ = true;
    if (character == ",") { // where no node of values is: see TreeReader::reportCommas()
        Diagnostic& comma = errors_.error("E0112", p, p + 1, "nothing is separated by commas", "remove the comma");
        errors_.fix(comma, p, p + 1, "");
        return p + 1;
    }
    Diagnostic& d = errors_.error("E0101", p, p + length, fmt::format("`{}` has no meaning here", character),
                                  "unexpected character");
    if (character == "[" || character == "]") d.help = "lists are plain values: `from 0 1 4`";
    if (character == "/")
        d.help = "a name that contains `/` needs quotes; a comment begins with `//`; "
                 "what is to be computed stands in quotes, `\"$r / 2\"`";
    return p + length;
}

} // namespace abbe::parser

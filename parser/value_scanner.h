// One value: a number, a bare word, a quoted text or a keyword, with its common misspellings repaired.
#pragma once

#include "parser/source_text.h"
#include "schema/document.h"

#include <vector>

namespace abbe::parser {

// Where a value stands decides what can be suggested.
enum class Place : std::uint8_t { argument, key };

class ValueScanner {
  public:
    ValueScanner(SyntaxErrors& errors, schema::Document& document) : errors_(errors), document_(document) {}

    // Scans the value at `p`, which is no white space and not the end of a node, and returns its end, always beyond
    // `p`. values() holds one value; after a repaired mistake none or two. lost() tells that not everything was
    // understood.
    const char* scan(const char* p, Place);
    const std::vector<schema::Value>& values() const { return values_; }
    bool lost() const { return lost_; }

    // The name of a node or key at `p`; sets text and span of `name`. Null when no name stands there.
    const char* scanName(const char* p, std::string_view& name);

  private:
    const char* scanNumber(const char* p, Place);
    const char* scanMalformed(const char* p, const char* end, Place);
    const char* scanFraction(const char* p, const char* end);
    const char* scanWord(const char* p);
    const char* scanForeignQuotes(const char* p);
    const char* scanHash(const char* p);
    const char* scanUnknownKeyword(const char* p, const char* end);
    const char* scanParentheses(const char* p);
    const char* scanOther(const char* p);
    bool checkBareKeyword(const char* p, const char* end);
    void add(schema::ValueKind, const char* from, const char* to, std::string_view text);
    void addNumber(const char* from, const char* to, double);
    void add(bool, const char* from, const char* to);

    SyntaxErrors& errors_;
    schema::Document& document_;
    std::vector<schema::Value> values_;
    bool lost_ = false;
};

// Whether a number begins at `p`: a digit, or a sign before a digit.
bool startsNumber(const char* p);
// Whether what begins at `p` is meant as a number without a digit before its point: `.5`, `-.5`.
bool startsPointNumber(const char* p);
// Whether [p, end) would be a keyword without its `#`: true false null inf -inf nan.
bool isBareKeyword(std::string_view word);

} // namespace abbe::parser

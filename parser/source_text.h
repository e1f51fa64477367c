// The text being scanned, and the reporting of syntax errors in it.
#pragma once

#include "base/diagnostic.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace abbe::parser {

// A text with a NUL after its last character, so that scanning needs no bounds checks.
struct SourceText {
    FileId file = FileId::none;
    const char* begin = nullptr;
    const char* end = nullptr; // *end == 0

    std::uint32_t offset(const char* p) const { return static_cast<std::uint32_t>(p - begin); }
    Span span(const char* from, const char* to) const { return {file, offset(from), offset(to)}; }
};

inline std::string_view between(const char* from, const char* to) {
    return {from, static_cast<std::size_t>(to - from)};
}

// Collects the syntax errors of one text and stops listing them after a thousand.
class SyntaxErrors {
  public:
    SyntaxErrors(SourceText text, Diagnostics& diagnostics) : text_(text), diagnostics_(diagnostics) {}

    // The returned diagnostic may be completed (fixes, help, related places) until the next call.
    Diagnostic& error(const char* code, const char* from, const char* to, std::string message, std::string label = {});
    void fix(Diagnostic&, const char* from, const char* to, std::string replacement) const;
    std::size_t count() const { return count_; }
    // Something without an end swallowed the rest of the text: what is missing at the end is a consequence.
    void markCutOff() { cutOff_ = true; }
    bool cutOff() const { return cutOff_; }
    const SourceText& text() const { return text_; }
    Diagnostics& diagnostics() { return diagnostics_; }

  private:
    static constexpr std::size_t kMost = 1000;
    SourceText text_;
    Diagnostics& diagnostics_;
    std::size_t count_ = 0;
    bool cutOff_ = false;
    Diagnostic unlisted_;
};

// False, with E0412, when the text is not well-formed UTF-8: then it cannot be scanned.
bool checkUtf8(SyntaxErrors&);
// The same; else reports every character that may not stand anywhere in a text, and the text can be scanned.
bool checkCharacters(SyntaxErrors&);

} // namespace abbe::parser

// The words of pbrt-v4's scene description: directives, quoted texts, numbers and brackets, with where they stand.
#pragma once

#include "base/source.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

struct PbrtToken {
    enum class Kind : std::uint8_t { end, word, text, number, open, close, fault };
    Kind kind = Kind::end;
    Span span;
    std::string_view raw; // as it stands in the file, of a text without its quotes
    double number = 0;
    const char* what = ""; // is wrong with a fault

    // A text with its escapes resolved.
    std::string text() const;
};

// Reads one file from its beginning. The text must outlive the scanner and be shorter than 4 GiB.
class PbrtScanner {
  public:
    PbrtScanner(std::string_view text, FileId file) : text_(text), file_(file) {}

    PbrtToken next();
    // The token that next() will return.
    const PbrtToken& peek();
    // Appends the numbers that follow, as far as there are any: meshes are millions of them.
    void numbers(std::vector<double>&);
    // Passes over the rest of a faulty directive: to the next word at the beginning of a line.
    void skipToDirective();

  private:
    void skipSpace();
    PbrtToken make(PbrtToken::Kind, std::size_t begin, std::size_t end);
    PbrtToken fault(std::size_t begin, std::size_t end, const char* what);
    PbrtToken quoted(std::size_t begin);
    PbrtToken wordOrNumber(std::size_t begin);

    std::string_view text_;
    FileId file_;
    std::size_t at_ = 0;
    PbrtToken peeked_;
    bool hasPeeked_ = false;
};

} // namespace abbe::exchange

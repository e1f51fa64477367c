// Every diagnostic code with a longer explanation: what `abbe explain E0105` prints.
#pragma once

#include <span>
#include <string_view>

namespace abbe {

struct CodeInfo {
    std::string_view code;        // "E0105"
    std::string_view title;       // one line, lower case
    std::string_view explanation; // a few sentences, with an example where that helps
};

// The entry of a code, or null.
const CodeInfo* findCode(std::string_view code);
// All entries, sorted by code within each range.
std::span<const CodeInfo> allCodes();

} // namespace abbe

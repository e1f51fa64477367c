// What stands in a page of HTML: bytes as base64, text and JSON so that they cannot be taken for markup.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace abbe {

// In one line, padded with `=`.
std::string base64(std::span<const unsigned char> bytes);
// For text and for attributes in quotes.
std::string htmlEscaped(std::string_view text);
// JSON inside a script element, which would end at the first "</script" of any text in it.
std::string scriptEscaped(std::string_view json);

} // namespace abbe

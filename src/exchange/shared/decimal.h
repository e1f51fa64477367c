// Decimal numbers of a few digits, as texts of scenes have them by the million: the same as std::from_chars and
// std::to_chars to the last bit, in less time.
#pragma once

#include <charconv>
#include <string>

namespace abbe::exchange {

// As std::from_chars(begin, end, value).
std::from_chars_result parseDecimal(const char* begin, const char* end, double& value);

// Appends the shortest text that reads back as the same number. Requires a finite one.
void appendDecimal(std::string& out, double value);

} // namespace abbe::exchange

// Text as a value of JSON.
#pragma once

#include <string>
#include <string_view>

namespace abbe {

// In quotes, with what JSON or a terminal would stumble over escaped; bytes that are no UTF-8 become U+FFFD.
std::string jsonText(std::string_view);

} // namespace abbe

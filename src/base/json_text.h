// Text as a value of JSON.
#pragma once

#include <string>
#include <string_view>

namespace abbe {

// In quotes, with what JSON or a terminal would stumble over escaped; other bytes stay, so UTF-8 does.
std::string jsonText(std::string_view);

} // namespace abbe

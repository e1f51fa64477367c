// Text from files as it may be shown on a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace abbe {

// Of a text that is not empty. Controls are what a terminal would obey instead of showing it: control characters (C0,
// DEL, C1), those that change the direction of writing, the byte order mark, and bytes that are no UTF-8.
struct FirstCharacter {
    std::size_t bytes = 1;
    bool control = false;
};
FirstCharacter firstCharacter(std::string_view text);

// The text with controls as `\u001b`, which is what JSON has in their place, too; bytes that are no UTF-8 as
// U+FFFD. Line ends and tabs go with the others, or stay where the text has several lines of its own.
std::string shownLine(std::string_view text);
std::string shownLines(std::string_view text);

} // namespace abbe

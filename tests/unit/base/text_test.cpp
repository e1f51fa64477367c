#include "base/text.h"

#include <doctest/doctest.h>
#include <string>

using namespace abbe;

TEST_CASE("what a terminal would obey is shown instead") {
    CHECK(shownLine("caf\u00e9 \u2192 \U0001f600 x\ufffdy") == "caf\u00e9 \u2192 \U0001f600 x\ufffdy");
    CHECK(shownLine("\x1b[31mred\x1b[0m") == "\\u001b[31mred\\u001b[0m");
    CHECK(shownLine("a\nb\tc\rd\x7f") == "a\\u000ab\\u0009c\\u000dd\\u007f");
    CHECK(shownLines("a\nb\tc\r\n") == "a\nb\tc\\u000d\n");
    CHECK(shownLine("\u0080\u009b31m") == "\\u0080\\u009b31m"); // C1, which terminals take for ESC [
    CHECK(shownLine("a\u202eb\u2066c\u200f\ufeff") == "a\\u202eb\\u2066c\\u200f\\ufeff");
    CHECK(shownLine(std::string_view("a\0b", 3)) == "a\\u0000b");
}

TEST_CASE("bytes that are no UTF-8 are shown as such, one by one") {
    CHECK(shownLine("\x9b[31m") == "\ufffd[31m");   // C1 of a terminal that is not set to UTF-8
    CHECK(shownLine("\xc0\x9b") == "\ufffd\ufffd"); // an overlong form
    CHECK(shownLine("\xe0\x82\x9b") == "\ufffd\ufffd\ufffd");
    CHECK(shownLine("\xed\xa0\x80") == "\ufffd\ufffd\ufffd"); // half of a surrogate pair
    CHECK(shownLine("\xf4\x90\x80\x80") == "\ufffd\ufffd\ufffd\ufffd");
    CHECK(shownLine("a\xe2\x80") == "a\ufffd\ufffd");
    CHECK(shownLine("\xe9t\xe9") == "\ufffdt\ufffd");
}

TEST_CASE("no text has a control character when it is shown") {
    std::string all;
    for (int a = 0; a < 256; ++a)
        for (int b = 0; b < 256; ++b) all += {static_cast<char>(a), static_cast<char>(b)};
    const std::string shown = shownLine(all);
    for (std::string_view rest = shown; !rest.empty();) {
        const FirstCharacter c = firstCharacter(rest);
        REQUIRE(!c.control);
        rest.remove_prefix(c.bytes);
    }
}

TEST_CASE("JSON has no control characters either, and means the same") {
    CHECK(jsonText("a\"b\\c\nd\x1b\u009b\x7f") == R"("a\"b\\c\nd\u001b\u009b\u007f")");
}

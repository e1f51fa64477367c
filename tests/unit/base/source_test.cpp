#include "base/source.h"

#include <doctest/doctest.h>

using namespace abbe;

TEST_CASE("lines end at LF, CR LF and CR; columns count code points") {
    SourceMap sources;
    const FileId file = sources.add("a", "ab\n\u00e9\U0001F600x\r\ncd\re");
    const auto at = [&](std::uint32_t offset) {
        const LineColumn place = sources.lineColumn(file, offset);
        return std::pair(place.line, place.column);
    };
    CHECK(at(0) == std::pair(1u, 1u));
    CHECK(at(2) == std::pair(1u, 3u));
    CHECK(at(3) == std::pair(2u, 1u));
    CHECK(at(9) == std::pair(2u, 3u)); // é has two bytes, the emoji four
    CHECK(at(12) == std::pair(3u, 1u));
    CHECK(at(15) == std::pair(4u, 1u));
    CHECK(at(16) == std::pair(4u, 2u)); // the end of the text
    CHECK(sources.line(file, 1) == "ab");
    CHECK(sources.line(file, 2) == "\u00e9\U0001F600x");
    CHECK(sources.line(file, 3) == "cd");
    CHECK(sources.line(file, 4) == "e");
    CHECK(sources.line(file, 5).empty());
}

TEST_CASE("an empty text has one empty line") {
    SourceMap sources;
    const FileId file = sources.add("a", "");
    CHECK(sources.lineColumn(file, 0).line == 1);
    CHECK(sources.line(file, 1).empty());
}

TEST_CASE("columns of long lines are those of short ones, in code points and in units of UTF-16") {
    SourceMap sources;
    std::string text = "first\n";
    for (int i = 0; i < 3000; ++i) text += i % 3 == 0 ? "\U0001F600" : i % 3 == 1 ? "\u00e9" : "x";
    const FileId file = sources.add("a", text + "\nlast");
    std::uint32_t offset = 6;
    for (std::uint32_t i = 0; i < 3000; ++i) {
        const std::uint32_t units = i + (i + 2) / 3; // every third has two
        const LineColumn place = sources.lineColumn(file, offset);
        if (place.line != 2 || place.column != i + 1 || sources.utf16Column(file, offset) != units)
            FAIL("character " << i << ": column " << place.column);
        offset += i % 3 == 0 ? 4 : i % 3 == 1 ? 2 : 1;
    }
    CHECK(sources.lineColumn(file, offset + 3).line == 3);
    CHECK(sources.lineColumn(file, offset + 3).column == 3);
    CHECK(sources.utf16Column(file, offset + 3) == 2);
}

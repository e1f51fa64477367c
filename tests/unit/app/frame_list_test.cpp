#include "app/frame_list.h"

#include <doctest/doctest.h>
#include <string>
#include <vector>

using namespace abbe;

namespace {

using Frames = std::vector<int>;

std::string faultOf(std::string_view text) {
    std::string fault;
    CHECK(readFrames(text, &fault).empty());
    return fault;
}

bool says(const std::string& fault, std::string_view part) { return fault.find(part) != std::string::npos; }

} // namespace

TEST_CASE("lists of frames") {
    CHECK(readFrames("7") == Frames{7});
    CHECK(readFrames("0007") == Frames{7});
    CHECK(readFrames("1-4") == Frames{1, 2, 3, 4});
    CHECK(readFrames("1-6x2") == Frames{1, 3, 5});
    CHECK(readFrames("1-7x2") == Frames{1, 3, 5, 7});
    CHECK(readFrames("5-5") == Frames{5});
    CHECK(readFrames("1-2,20,30-40x5") == Frames{1, 2, 20, 30, 35, 40});
    CHECK(readFrames("1-2, 4") == Frames{1, 2, 4});
    CHECK(readFrames("-3") == Frames{-3});
    CHECK(readFrames("-3--1") == Frames{-3, -2, -1});
    CHECK(readFrames("-1-1") == Frames{-1, 0, 1});
    CHECK(readFrames("2147483646-2147483647") == Frames{2147483646, 2147483647});
    CHECK(readFrames("1-1000000").size() == 1000000);
}

TEST_CASE("a frame that is named twice is rendered once, where it is named first") {
    CHECK(readFrames("5,1-6x2,1") == Frames{5, 1, 3});
}

TEST_CASE("what is no list of frames is told, with what may be meant") {
    CHECK(says(faultOf(""), "missing"));
    CHECK(says(faultOf("1,,2"), "missing"));
    CHECK(says(faultOf("1,"), "missing"));
    CHECK(says(faultOf("1-"), "`1-` has no last frame; write `1` or, say, `1-100`"));
    CHECK(says(faultOf("10-1"), "`10-1` ends before it begins; write `1-10`"));
    CHECK(says(faultOf("10-1x3"), "write `1-10x3`"));
    CHECK(says(faultOf("1-9x"), "`1-9x2`"));
    CHECK(says(faultOf("1-9x0"), "step"));
    CHECK(says(faultOf("1-9x-2"), "step"));
    CHECK(says(faultOf("1-5y"), "goes on with `y`"));
    CHECK(says(faultOf("1.5"), "goes on with `.5`"));
    CHECK(says(faultOf("all"), "does not begin with the number of a frame"));
    CHECK(says(faultOf("99999999999"), "does not begin with the number of a frame"));
    CHECK(says(faultOf("1-1000000000"), "more than 1000000 frames"));
    CHECK(says(faultOf("1-600000,700000-1300000"), "more than 1000000 frames"));
    CHECK(says(faultOf("-2147483648-2147483647"), "more than 1000000 frames"));
    CHECK(readFrames("1-").empty()); // nobody asks why
}

TEST_CASE("lists are told as they are written") {
    CHECK(frameListText({}).empty());
    for (const char* text : {"7", "1-240", "1-239x2", "1-3,7", "1,20,30-40x5", "-3--1", "9,8,7"})
        CHECK(frameListText(readFrames(text)) == text);
    CHECK(frameListText({1, 2}) == "1-2");
    CHECK(frameListText({1, 5}) == "1,5");
}

TEST_CASE("files of frames") {
    CHECK(framePath("shot.####.exr", 7) == "shot.0007.exr");
    CHECK(framePath("shot.#.exr", 12) == "shot.12.exr");
    CHECK(framePath("shot_######.exr", 12) == "shot_000012.exr");
    CHECK(framePath("####", 12) == "0012");
    CHECK(framePath("shot.exr", 1) == "shot.0001.exr");
    CHECK(framePath("shot", 1) == "shot.0001");
    CHECK(framePath("shot.v2.exr", 12345) == "shot.v2.12345.exr");
    CHECK(framePath("a/b.c/shot.exr", 1) == "a/b.c/shot.0001.exr");
    CHECK(framePath("a#b/shot.##.exr", 1) == "a#b/shot.01.exr");
    CHECK(framePath("./shot.exr", 1) == "./shot.0001.exr");
    CHECK(framePath("shot.####.exr", -7) == "shot.-0007.exr");
    CHECK(framePath("shot.####.exr", -2147483647 - 1) == "shot.-2147483648.exr");
}

TEST_CASE("a pattern has one place for the number") {
    CHECK(framePatternFault("shot.####.exr").empty());
    CHECK(framePatternFault("#1/shot.####.exr").empty());
    CHECK(framePatternFault("shot.exr").empty());
    CHECK(says(framePatternFault("shot.##.##.exr"), "as in `shot.##.__.exr`"));
}

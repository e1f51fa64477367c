// Braces that are missing, superfluous, swapped or brackets: one or two errors at the right place, and the rest of the
// file is read as it was meant.
#include "base/diagnostic.h"
#include "parse_text.h"

#include <doctest/doctest.h>

using namespace abbe;
using abbe::test::Parsed;
using abbe::test::parseText;

namespace {

const std::string kMeant = R"(scene 1
camera {
    from 0 1 3
    fov 40 deg
}
group pair {
    shape sphere {
        radius 1
        transform {
            rotate y 45 deg
        }
    }
    shape plane
}
light sky { luminance 5 nits }
)";

std::string with(const std::string& from, const std::string& to) {
    std::string text = kMeant;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

// "E0110 at line 2 column 8"
std::string places(const Parsed& parsed) {
    std::string list;
    for (const Diagnostic& d : parsed.diagnostics.all()) {
        const LineColumn place = parsed.sources->lineColumn(parsed.file, d.span.begin);
        list += fmt::format("{}{} {}:{}", list.empty() ? "" : ", ", d.code, place.line, place.column);
    }
    return list;
}

// The errors of a text that is read as if it were right.
std::string errorsOf(const std::string& text) {
    const Parsed parsed = parseText(text);
    CHECK_MESSAGE(parsed.printed() == parseText(kMeant).printed(), text << "\n" << parsed.printed());
    return places(parsed);
}

std::string repairedText(const std::string& text) {
    const Parsed parsed = parseText(text);
    return applyFixes(text, parsed.file, parsed.diagnostics).text;
}

} // namespace

TEST_CASE("braces: a missing closing one ends its block where lines are no longer indented") {
    CHECK(errorsOf(with("    fov 40 deg\n}\n", "    fov 40 deg\n")) == "E0110 2:8");
    CHECK(errorsOf(with("        }\n    }\n    shape plane", "        }\n    shape plane")) == "E0110 7:18");
    CHECK(errorsOf(with("deg\n        }\n", "deg\n")) == "E0110 9:19");
    CHECK(errorsOf(with("    shape plane\n}\n", "    shape plane\n")) == "E0110 6:12");
    CHECK(errorsOf(with("5 nits }\n", "5 nits\n")) == "E0110 15:11");
    const Parsed parsed = parseText(with("    fov 40 deg\n}\n", "    fov 40 deg\n"));
    REQUIRE(parsed.diagnostics.all()[0].related.size() == 1);
    CHECK(parsed.sources->lineColumn(parsed.file, parsed.diagnostics.all()[0].related[0].span.begin).line == 5);
}

TEST_CASE("braces: two missing ones, and one behind the block of one line") {
    CHECK(places(parseText("camera { fov 40 deg\nlight sky { }\nshape plane {\n  a 1\nfilm { }\n")) ==
          "E0110 1:8, E0110 3:13");
    CHECK(places(parseText("a {\n  b {\n    c 1\nd 2\n")) == "E0110 2:5, E0110 1:3");
}

TEST_CASE("braces: files without indentation are read on at the next definition") {
    const Parsed parsed = parseText("camera {\nfov 40\nlight sky {\nluminance 5\n}\nshape plane\n");
    CHECK(places(parsed) == "E0110 1:8");
    CHECK(parsed.printed() == parseText("camera {\nfov 40\n}\nlight sky {\nluminance 5\n}\nshape plane\n").printed());
}

TEST_CASE("braces: a superfluous closing one is that which is indented like an inner line") {
    CHECK(errorsOf(with("    shape plane\n", "    }\n    shape plane\n")) == "E0111 13:5");
    CHECK(errorsOf(with("radius 1\n", "radius 1 }\n")) == "E0111 8:18");
    CHECK(errorsOf(kMeant + "}\n") == "E0111 16:1");
    CHECK(errorsOf(with("deg\n}\n", "deg\n}\n}\n")) == "E0111 6:1");
}

TEST_CASE("braces: a missing opening one is missed where lines are indented without it") {
    CHECK(errorsOf(with("camera {", "camera")) == "E0127 2:7");
    CHECK(errorsOf(with("transform {", "transform")) == "E0127 9:18");
    CHECK(errorsOf(with("camera {", "camera // the eye")) == "E0127 2:7");
    CHECK(repairedText(with("camera {", "camera")) == kMeant);
    CHECK(repairedText(with("camera {", "camera // the eye")) == with("camera {", "camera { // the eye"));
    // Where the block begins in a line of its own cannot be told.
    CHECK(places(parseText(with("sky { lum", "sky lum"))) == "E0127 15:1");
}

TEST_CASE("braces: swapped ones are one mistake") {
    const std::string swapped = with("camera {\n    from 0 1 3\n    fov 40 deg\n}", //
                                     "camera }\n    from 0 1 3\n    fov 40 deg\n{");
    CHECK(errorsOf(swapped) == "E0111 2:8");
    CHECK(repairedText(swapped) == kMeant);
    CHECK(errorsOf(with("transform {", "transform }")) == "E0111 9:19");
    CHECK(errorsOf(with("deg\n        }\n", "deg\n        {\n")) == "E0121 11:9");
}

TEST_CASE("braces: parentheses and brackets in their place") {
    const std::string round = with("camera {\n    from 0 1 3\n    fov 40 deg\n}", //
                                   "camera (\n    from 0 1 3\n    fov 40 deg\n)");
    CHECK(errorsOf(round) == "E0126 2:8");
    CHECK(repairedText(round) == kMeant);
    CHECK(errorsOf(with("transform {\n            rotate y 45 deg\n        }",
                        "transform [\n            rotate y 45 deg\n        ]")) == "E0126 9:19");
    CHECK(errorsOf(with("sky { luminance 5 nits }", "sky ( luminance 5 nits )")) == "E0126 15:11");
    CHECK(errorsOf(with("deg\n        }\n", "deg\n        )\n")) == "E0126 11:9");
}

TEST_CASE("braces: many wrong ones take no longer than they are long") {
    for (const char* line :
         {"a (\n", "a }\n  b\n", "a\n  b }\n", "a {\n", "{\n", "}\n", "a [\n}\n", "camera (b c)\n"}) {
        std::string text;
        for (int i = 0; i < 100'000; ++i) text += line;
        CHECK(parseText(text).diagnostics.errorCount() > 0);
    }
}

TEST_CASE("braces: right ones are never doubted, however they are indented") {
    for (const char* text : {"camera\n{\n  fov 40\n}\nlight sky {\nluminance 5\n}\n", "a {\n b {\n c 1 }\n}\n",
                             "a { b 1; c {\n d 2\n } }\n", "  a {\nb 1\n      }\nc\n",
                             "a \"{\"\nb /* { */ 1 // }\nc #\"}\"#\n", "a 1 \\\n    2\nb\n"})
        CHECK_MESSAGE(parseText(text).codes().find("E011") == std::string::npos, text << parseText(text).errors());
}

// Quoted, raw and several-line texts of KDL 2.0.0.
#include "parse_text.h"

#include <doctest/doctest.h>

using namespace abbe;
using abbe::test::parseText;

namespace {

// The first value of the first node.
std::string text(const std::string& source) {
    const auto parsed = parseText("n " + source + "\n");
    if (!parsed.diagnostics.all().empty()) return parsed.errors();
    REQUIRE(parsed.root().valueCount() == 1);
    CHECK(parsed.root().value(0).kind == schema::ValueKind::string);
    CHECK(parsed.sources->text(parsed.root().value(0).span) == source);
    return std::string(parsed.root().value(0).text);
}

std::string codes(const std::string& source) { return parseText("n " + source + "\n").codes(); }

} // namespace

TEST_CASE("escapes") {
    CHECK(text(R"("a\nb\r\t\\\"\b\f\s|")") == "a\nb\r\t\\\"\b\f |");
    CHECK(text(R"("\u{41}\u{00e9}\u{1F600}\u{10FFFF}")") == "A\u00e9\U0001F600\U0010FFFF");
    CHECK(text("\"a\\   \t b\"") == "ab");
    CHECK(text("\"a\\\n   b\"") == "ab");
    CHECK(text("\"a\\ \r\n\r\n b\"") == "ab");
    CHECK(text("\"\"").empty());
    CHECK(text("\"\u00e9\u3000\"") == "\u00e9\u3000");
}

TEST_CASE("wrong escapes are reported one by one, with a repair") {
    CHECK(codes(R"("\q")") == "E0115@3-5");
    CHECK(codes(R"("\/ \x")") == "E0115@3-5 E0115@6-8");
    CHECK(codes(R"("\u{}")") == "E0115@3-5");
    CHECK(codes(R"("\u{D800}")") == "E0115@3-5");
    CHECK(codes(R"("\u{110000}")") == "E0115@3-5");
    CHECK(codes(R"("\u{1234567}")") == "E0115@3-5");
    CHECK(codes(R"("\u41")") == "E0115@3-5");
    CHECK(codes("\"\\\u00e9\"") == "E0115@3-6");
}

TEST_CASE("raw texts") {
    CHECK(text(R"(#"a\n"b"#)") == R"(a\n"b)");
    CHECK(text(R"(##"a"#b"##)") == R"(a"#b)");
    CHECK(text(R"(#""#)").empty());
    CHECK(text(R"(#"\"#)") == "\\");
    CHECK(text(R"(#""a"#)") == "\"a");
}

TEST_CASE("texts of several lines lose the indentation of their closing quotes") {
    CHECK(text("\"\"\"\n    a\n      b\n    \"\"\"") == "a\n  b");
    CHECK(text("\"\"\"\n\"\"\"").empty());
    CHECK(text("\"\"\"\n\n\"\"\"").empty());
    CHECK(text("\"\"\"\n  a\n\n  \t \n  b\n  \"\"\"") == "a\n\n\nb");
    CHECK(text("\"\"\"\r\n  a\r\n  b\r\n  \"\"\"") == "a\nb");
    CHECK(text("\"\"\"\n  a \"quoted\" \"\"b\n  \"\"\"") == "a \"quoted\" \"\"b");
    CHECK(text("\"\"\"\n  a\\n  b\\s\n  \"\"\"") == "a\n  b ");
    CHECK(text("\"\"\"\n  a \\\n     b\n  \"\"\"") == "a b");
    CHECK(text("\"\"\"\n  foo \\\nbar\n  baz\n  \\   \"\"\"") == "foo bar\nbaz");
    CHECK(text("\"\"\"\n  a\\\"\"\"b\n  \"\"\"") == "a\"\"\"b");
    CHECK(text("#\"\"\"\n  a\\n\"\"\"\n  b\n  \"\"\"#") == "a\\n\"\"\"\nb");
    CHECK(text("\"\"\"\n\ta\n\t\"\"\"") == "a");
}

TEST_CASE("badly laid out texts") {
    CHECK(codes("\"\"\"a\"\"\"") == "E0116@2-5");
    CHECK(codes("\"\"\"a\n  \"\"\"") == "E0116@2-5");
    CHECK(codes("\"\"\"\n  a\"\"\"") == "E0116@9-12");
    CHECK(codes("\"\"\"\n a\n  b\n  \"\"\"") == "E0116@6-7");
    CHECK(codes("\"\"\"\n\ta\n  b\n  \"\"\"") == "E0116@6-7");
    CHECK(codes("\"\"\"\n  foo\n  bar\\\n  \"\"\"") == "E0116@21-24");
}

TEST_CASE("texts without an end are closed at the end of their line, or before a brace") {
    const auto line = parseText("n \"abc def\nm 1\n");
    CHECK(line.codes() == "E0103@2-3");
    CHECK(line.printed() == "n \"abc def\"\nm 1\n");
    const auto brace = parseText("n \"abc { m 1 }\no 2\n");
    CHECK(brace.codes() == "E0103@2-3");
    CHECK(brace.printed() == "n \"abc\" {\n    m 1\n}\no 2\n");
    const auto paired = parseText("n \"abc { m \"x\" }\no 2\n");
    CHECK(paired.codes() == "E0103@2-3");
    CHECK(parseText("n #\"abc\nm 1\n").codes() == "E0103@2-4");
    CHECK(parseText("n {\n m \"\"\"\n a\n").codes() == "E0103@7-10");
    CHECK(parseText("n \"abc").codes() == "E0103@2-3");
    CHECK(parseText("n \"abc\\").codes() == "E0103@2-3");
}

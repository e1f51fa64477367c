// Mistakes: each gives one error at its place, and everything else is still read.
#include "base/diagnostic.h"
#include "parse_text.h"

#include <doctest/doctest.h>
#include <utility>

using namespace abbe;
using abbe::test::parseText;

namespace {

// The text after `check --fix`.
std::string fixed(const std::string& source) {
    const auto parsed = parseText(source);
    return applyFixes(parsed.sources->text(parsed.file), parsed.file, parsed.diagnostics).text;
}

} // namespace

TEST_CASE("repairs: the code, and the text after them, which has no mistake left") {
    struct Case {
        std::string source;
        std::string code;
        std::string repaired;
    };
    for (const Case& c : {
             Case{"lens 85mm", "E0105@5-9", "lens 85 mm"},
             Case{"lens -8.5e1mm 2", "E0105@5-13", "lens -8.5e1 mm 2"},
             Case{"fov 90\u00b0", "E0105@4-8", "fov 90 deg"},
             Case{"noise .5%", "E0105@6-9", "noise 0.5 %"},
             Case{"a .5", "E0106@2-4", "a 0.5"},
             Case{"a -.5 b", "E0106@2-5", "a -0.5 b"},
             Case{"a 1.", "E0106@2-4", "a 1.0"},
             Case{"a 1.e5", "E0106@2-6", "a 1.0e5"},
             Case{"a true", "E0107@2-6", "a on"},
             Case{"a null", "E0107@2-6", "a #null"},
             Case{"a -inf", "E0107@2-6", "a #-inf"},
             Case{"null 1", "E0107@0-4", "\"null\" 1"},
             Case{"# note\na", "E0108@0-1", "// note\na"},
             Case{"a 1 ## note", "E0108@4-6", "a 1 // note"},
             Case{"film\n{\n  a\n}", "E0109@5-6", "film {\n  a\n}"},
             Case{"a 1, 2,3", "E0112@3-4", "a 1 2 3"},
             Case{"a b, c", "E0112@3-4", "a b c"},
             Case{"fov = 40", "E0113@4-5", "fov 40"},
             Case{"fov=40", "E0113@3-4", "fov 40"},
             Case{"a 'b c'", "E0114@2-7", "a \"b c\""},
             Case{"a \u201cb\u201d", "E0114@2-9", "a \"b\""},
             Case{"a \"C:\\data\"", "E0115@5-7", "a \"C:\\\\data\""},
             Case{"a \"\"\"b\"\"\"", "E0116@2-5", "a \"b\""},
             Case{"s \"1/48\" 1/48", "E0117@9-13", "s \"1/48\" \"1/48\""},
             Case{"a 0.5f", "E0117@2-6", "a 0.5"},
             Case{"size 512x256", "E0117@5-12", "size 512 256"},
             Case{"a \"b\"c", "E0120@5-5", "a \"b\" c"},
             Case{"points {\n 1 2 3\n}", "E0121@10-11", "points {\n - 1 2 3\n}"},
             Case{"a { b } c", "E0124@8-9", "a { b }; c"},
             Case{"a #ff8000", "E0125@2-9", "a \"#ff8000\""},
             Case{"param angle 1\na $angel $angle", "E0204@16-22", "param angle 1\na $angle $angle"},
         }) {
        CHECK_MESSAGE(parseText(c.source).codes() == c.code, c.source);
        CHECK_MESSAGE(fixed(c.source) == c.repaired, c.source);
        CHECK_MESSAGE(parseText(c.repaired).codes().empty(), c.repaired);
    }
}

TEST_CASE("mistakes without a mechanical repair") {
    for (const auto& [source, codes] : std::vector<std::pair<std::string, std::string>>{
             {"a [1 2 3]", "E0101@2-3"},
             {"[1 2 3]", "E0101@0-1 E0101@6-7"},
             {"a \\ b", "E0101@2-3"},
             {"a b/c", "E0101@3-4"},
             {"a ) b", "E0101@2-3"},
             {"a /* b", "E0104@2-4"},
             {"a { /* b /* c */", "E0104@4-6"},
             {"{ a }", "E0121@0-1"},
             {"a }", "E0111@2-3"},
             {"a 0,5", "E0112@3-4"},
             {"a k=", "E0113@3-4"},
             {"a 1 = 2", "E0113@4-5"},
             {"a 5=3", "E0113@2-4"},
             {"= 3", "E0113@0-1"},
             {"0x10 // c", "E0121@0-4"},
             {"1/48", "E0117@0-4"},
             {"a 'b", "E0114@2-4"},
             {"a 12abc 3", "E0117@2-7"},
             {"a 0xZZ", "E0117@2-6"},
             {"a 1e400", "E0118@2-7"},
             {"- 1 -1e400 2", "E0118@4-10"},
             {"a rgb(1, 2, 3) 4", "E0123@5-14"},
             {"a (", "E0123@2-3"},
             {"a { b } { c }", "E0124@8-9"},
             {"a #yes", "E0125@2-6"},
             {"a k=85mm", "E0105@4-8"},
         })
        CHECK_MESSAGE(parseText(source).codes() == codes, source);
}

TEST_CASE("what follows a mistake is read") {
    CHECK(parseText("a 85mm .5 true 1e400 12x \"b\n c").printed() == "a 85 mm 0.5 #true 1 12x \"b\"\nc\n");
    CHECK(parseText("a rgb(1, 2, 3) 4\nb 1").printed() == "a rgb 4\nb 1\n");
    CHECK(parseText("1 2\nb").printed() == "- 1 2\nb\n");
    CHECK(parseText("? = 3\nb").printed() == "\"?\" 3\nb\n");
    CHECK(parseText("film\n\n  // c\n {\n a 1 }\nb").printed() == "film {\n    a 1\n}\nb\n");
    CHECK(parseText("{ a }\nb").printed() == "b\n");
    CHECK(parseText("a { b } { c }\nd").printed() == "a {\n    b\n}\nd\n");
    CHECK(parseText("a }\nb").printed() == "a\nb\n");
}

TEST_CASE("nodes that lost something are marked") {
    CHECK(!parseText("a 85mm").root().damaged());
    CHECK(parseText("a 1e400").root().damaged());
    CHECK(parseText("a rgb(1)").root().damaged());
    CHECK(parseText("a $nothing").root().damaged());
    CHECK(parseText("a {\n b 1\n").root().damaged());
}

TEST_CASE("the unclosed brace is the one whose block ends at the wrong indentation") {
    const auto inner = parseText("camera {\n    film {\n        size 1\n    lens 3\n}\nlight x {\n    y 2\n}\n");
    CHECK(inner.codes() == "E0110@18-19");
    REQUIRE(inner.diagnostics.all()[0].related.size() == 1);
    CHECK(inner.diagnostics.all()[0].related[0].span.begin == 39);
    CHECK(parseText("camera {\n    from 1\nlight sky { }\n").codes() == "E0110@7-8");
    CHECK(parseText("a {\n  b {\n").codes() == "E0110@2-3 E0110@8-9");
    // One forgotten, and later a stray one: no complaint about the end.
    CHECK(parseText("a {\n  b {\n}\n").codes() == "E0110@8-9");
}

TEST_CASE("depth is bounded, and deep texts are read in linear time") {
    const auto nested = [](int depth) {
        std::string text;
        for (int i = 0; i < depth; ++i) text += "a { ";
        for (int i = 0; i < depth; ++i) text += "} ";
        return text + "\nb";
    };
    CHECK(parseText(nested(256)).codes().empty());
    CHECK(parseText(nested(257)).codes() == "E0119@1026-1027");
    const auto deep = parseText(nested(1'000'000));
    CHECK(deep.codes() == "E0119@1026-1027");
    CHECK(deep.root(1).name() == "b");
    CHECK(parseText(std::string(2'000'000, '{')).diagnostics.errorCount() < 300);
    std::string chain = nested(256);
    chain.resize(256 * 4);
    for (int i = 0; i < 300'000; ++i) chain += "a {} {} ";
    CHECK(parseText(chain).diagnostics.errorCount() > 0);
}

TEST_CASE("a hostile text takes linear time and gives a bounded list") {
    std::vector<std::string> units = {
        "(",  ")", "\"a\"b", "'a ", "\u201c", "#",  "# ", "a=", "=",      "85mm ", "/*",       "\\",
        "/-", "}", "[",      "a;",  "$a ",    "1,", "\"", "1=", "a k=1 ", ".5 ",   "\"\"\"\n", "a {}{}"};
    for (const std::string& unit : units) {
        std::string text;
        while (text.size() < 300'000) text += unit;
        const auto parsed = parseText("n " + text);
        CHECK_MESSAGE(parsed.diagnostics.all().size() <= 60'000 / 2 * 10, unit);
    }
}

TEST_CASE("no more than a thousand syntax errors are listed") {
    std::string text;
    for (int i = 0; i < 5000; ++i) text += "a 85mm\n";
    const auto parsed = parseText(text);
    CHECK(parsed.diagnostics.errorCount() == 1001);
    CHECK(parsed.diagnostics.all().back().code == "E0199");
    CHECK(parsed.document->nodes.size() == 5000);
}

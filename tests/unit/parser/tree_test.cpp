// The tree: names, values, keys, blocks, comments, slashdashes and white space of KDL 2.0.0.
#include "parse_text.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;
using abbe::test::parseText;
using abbe::test::printedText;

TEST_CASE("nodes, values, keys and blocks") {
    CHECK(printedText("a 1 \"b\" c k=2 d { e; f { g } }\nh") ==
          "a 1 \"b\" c d k=2 {\n    e\n    f {\n        g\n    }\n}\nh\n");
    CHECK(printedText("").empty());
    CHECK(printedText("\n\n // nothing\n").empty());
    CHECK(printedText("a{}") == "a {\n}\n");
    CHECK(printedText("a {}") == "a {\n}\n");
    CHECK(printedText("a {b}") == "a {\n    b\n}\n");
    CHECK(printedText("a { b; }; c") == "a {\n    b\n}\nc\n");
    CHECK(printedText("\"quoted name\" 1") == "\"quoted name\" 1\n");
    CHECK(printedText("- -- -a .a +a <b> a.b:c-d $").starts_with("test.scene:1:27: error[E0204]"));
    CHECK(printedText("- -- -a .a +a <b> a.b:c-d") == "- -- -a .a +a <b> a.b:c-d\n");
    CHECK(printedText("\u6728 \u00fcber=\u65e5\u672c") == "\"\u6728\" \"\u00fcber\"=\u65e5\u672c\n");
}

TEST_CASE("numbers and keywords") {
    CHECK(printedText("a 1 -2.5 +3 1e3 0x10 0o10 0b10 1_0") == "a 1 -2.5 3 1000 16 8 2 10\n");
    CHECK(printedText("a #true #false #null #inf #-inf #nan") == "a #true #false #null #inf #-inf #nan\n");
    CHECK(printedText("a k=#true l=#null m=-1") == "a k=#true l=#null m=-1\n");
}

TEST_CASE("white space, comments and continued lines") {
    CHECK(printedText("\ufeffa 1") == "a 1\n");
    CHECK(printedText("a\u00a01\u30002") == "a 1 2\n");
    for (const char* newline : {"\n", "\r", "\r\n", "\v", "\f", "\u0085", "\u2028", "\u2029"})
        CHECK(printedText(std::string("a 1") + newline + "b 2") == "a 1\nb 2\n");
    CHECK(printedText("a 1 \\\n 2 \\ // why\n 3 \\ /* x */ \r\n 4") == "a 1 2 3 4\n");
    CHECK(printedText("a \\") == "a\n");
    CHECK(printedText("a/* x */1 /* a /* nested */ b */ 2// end") == "a 1 2\n");
    CHECK(printedText("/* x */ a 1 // y\n// z") == "a 1\n");
    CHECK(printedText("a k = 1 l= 2 m =3") == "a k=1 l=2 m=3\n");
    CHECK(printedText("a k/* x */=/* y */1") == "a k=1\n");
}

TEST_CASE("type annotations are accepted and ignored") {
    CHECK(printedText("(t)a (u8)1 k=(i8)2 ( \"x\" ) b") == "a 1 b k=2\n");
    CHECK(printedText("(t) a (u8) 1 { (x)b }") == "a 1 {\n    b\n}\n");
    CHECK(parseText("a (u8)").codes() == "E0123@2-6");
    CHECK(parseText("a (1)2").codes() == "E0123@2-5");
    CHECK(parseText("a (t)k=2").codes() == "E0123@2-5");
}

TEST_CASE("slashdash") {
    CHECK(printedText("/-a 1 { b }\nc") == "c\n");
    CHECK(printedText("/- \n // x\n a 1\nc") == "c\n");
    CHECK(printedText("a /-1 2 /-k=3 l=4 /-b c") == "a 2 c l=4\n");
    CHECK(printedText("a 1 /-2 3") == "a 1 3\n");
    CHECK(printedText("a /-\n 1 2") == "a 2\n");
    CHECK(printedText("a /-{ b } { c } /-{ d }") == "a {\n    c\n}\n");
    CHECK(printedText("a 1 /-{ b { c } }\nd") == "a 1\nd\n");
    CHECK(printedText("a { /-b; c; /-d { e } }") == "a {\n    c\n}\n");
    CHECK(printedText("/- kdl-version 2\na") == "a\n");
    CHECK(parseText("/-{ a }\nb").codes() == "E0121@2-3");
    CHECK(parseText("a { /- }").codes() == "E0122@4-6");
    CHECK(parseText("a /-").codes() == "E0122@2-4");
    CHECK(parseText("/- /- a").codes() == "E0122@0-2");
    CHECK(parseText("a k=/-1").codes() == "E0122@4-6");
}

TEST_CASE("of equal keys the last one counts, with a warning") {
    const auto parsed = parseText("a k=1 l=2 k=3");
    CHECK(parsed.printed() == "a l=2 k=3\n");
    CHECK(parsed.codes() == "W0101@2-3");
    CHECK(parsed.diagnostics.warningCount() == 1);
}

TEST_CASE("a key that is given often is one warning with a count, and the names of a node one each") {
    const auto parsed = parseText("a k=1 l=1 k=2 k=3 l=2 m=1 k=4\nb k=1 k=2");
    CHECK(parsed.printed() == "a l=2 m=1 k=4\nb k=2\n");
    CHECK(parsed.codes() == "W0101@2-3 W0101@6-7 W0101@32-33");
    CHECK(parsed.diagnostics.all()[0].message == "the key `k` is given 4 times");
    CHECK(parsed.diagnostics.all()[0].related[0].span.begin == 26);
    CHECK(parsed.diagnostics.all()[1].message == "the key `l` is given twice");
}

TEST_CASE("spans") {
    const auto parsed = parseText("// c\nab 1.5 \"x\" key=word { c }\nd\n");
    const schema::Node node = parsed.root();
    const auto text = [&](Span span) { return std::string(parsed.sources->text(span)); };
    CHECK(text(node.nameSpan()) == "ab");
    CHECK(text(node.headSpan()) == "ab 1.5 \"x\" key=word");
    CHECK(text(node.span()) == "ab 1.5 \"x\" key=word { c }");
    CHECK(text(node.value(0).span) == "1.5");
    CHECK(node.value(0).text == "1.5");
    CHECK(text(node.value(1).span) == "\"x\"");
    CHECK(text(node.keys()[0].nameSpan) == "key");
    CHECK(text(node.keys()[0].value.span) == "word");
    CHECK(text((*node.children().begin()).span()) == "c");
    CHECK(text(parsed.root(1).span()) == "d");
}

TEST_CASE("rows of numbers are packed, and every one is found again in the text") {
    std::string row = "- 0";
    for (int i = 1; i < 1000; ++i)
        row += i % 7 == 0    ? " /* 5 // 6 */ " + std::to_string(-i)
               : i % 11 == 0 ? " \\\n\t" + std::to_string(i)
                             : " " + std::to_string(i);
    const auto parsed = parseText("first 1 2 3\n" + row + "\nlast word 4 5\n");
    REQUIRE(parsed.diagnostics.all().empty());
    const schema::Node node = parsed.root(1);
    REQUIRE(node.allNumbers());
    REQUIRE(node.valueCount() == 1000);
    REQUIRE(node.numbers().size() == 1000);
    std::size_t place = 0;
    for (const double number : node.numbers()) CHECK(std::abs(number) == static_cast<double>(place++));
    CHECK(*node.numbers().without(990).begin() == 990);
    CHECK(node.numbers().without(990).size() == 10);
    CHECK(parsed.document->values.size() == 1); // `word`
    for (std::size_t i = 0; i < 1000; ++i) {
        const schema::Value value = node.value(i);
        CHECK(std::abs(value.number) == static_cast<double>(i));
        CHECK(parsed.sources->text(value.span) == fmt::format("{}", value.number));
    }
    const schema::Node last = parsed.root(2);
    CHECK(!last.allNumbers());
    REQUIRE(last.valueCount() == 3);
    CHECK(last.value(0).text == "word");
    CHECK(parsed.sources->text(last.value(2).span) == "5");
}

// A block that is read node by node, as it has a comment that is none of a row.
std::string printedSlowly(const std::string& head, const std::string& body) {
    const auto parsed = parseText(head + " { /* slowly */" + body + "}\nlast 7\n");
    CHECK(parsed.errors().empty());
    CHECK((*parsed.document->roots().begin()).packedRows() == 0);
    return parsed.printed();
}

TEST_CASE("blocks of rows of plain numbers have no records, and are the same tree") {
    for (const std::string body : {"\n    - 1 2 3\n    - -4 +5.5 6e2\n", " - 1; - 2; ", "- 1 2}\nb { - 3",
                                   "\r\n\t- 1\t2\r\n- 3 4 // - 5\r\n// - 6 7\r\n- 8",
                                   "\n- 0.1 1e-400 123456789012345678901234567890\n", " // }\n - 1\n\n\n - 2;\n"}) {
        INFO(body);
        const auto parsed = parseText("a k=1 {" + body + "}\nlast 7\n");
        CHECK(parsed.errors().empty());
        CHECK(parsed.root().packedRows() > 0);
        CHECK(parsed.document->nodes.size() == (body.find('b') == std::string::npos ? 2 : 3));
        CHECK(parsed.document->values.empty());
        CHECK(parsed.printed() == printedSlowly("a k=1", body));
        for (const schema::Node row : parsed.root().children()) {
            CHECK(row.allNumbers());
            CHECK((!row.hasBlock() && !row.damaged() && row.keys().empty() && row.children().empty()));
            CHECK(parsed.sources->text(row.nameSpan()) == "-");
            CHECK(row.span() == row.headSpan());
            CHECK(row.headSpan().end == row.value(row.valueCount() - 1).span.end);
            std::size_t i = 0;
            for (const double number : row.numbers()) CHECK(row.value(i++).number == number);
            CHECK(i == row.valueCount());
        }
    }
    // What is odd in one row is left to the reader of nodes, for all of them.
    std::string longRow = " - 1";
    for (int i = 0; i < 64; ++i) longRow += " 2";
    for (const std::string& body :
         {std::string(""), std::string("\n"), std::string(" - "), std::string(" - a"), std::string(" - 1 mm"),
          std::string(" - 1; x 2"), std::string(" - 1 { }"), std::string(" - 1 k=2"), std::string(" - 1_0"),
          std::string(" - 0x10"), std::string(" - #inf"), std::string(" - 1 \\\n 2"), std::string(" /- - 1"),
          std::string(" - 1 /* 2 */"), std::string(" -1 2"), std::string(" - 1\n-"), std::string(" - \"1\""),
          std::string(" // \u2028 - 5\n - 1\n"), longRow}) {
        INFO(body);
        const auto parsed = parseText("a {" + body + "\n}\nlast 7\n");
        CHECK(parsed.root().packedRows() == 0);
        if (parsed.errors().empty()) CHECK(parsed.printed() == printedSlowly("a", body + "\n"));
    }
    CHECK(parseText("a { - 1 2\n").codes() == "E0110@2-3");
    CHECK(parseText("a { - 1 2; - 1e999 }").codes() == "E0118@13-18");
    CHECK(parseText("a { - 1 2; - 1,5 }").codes() == "E0112@14-15");
    CHECK(parseText("a 1 2 { - 3 }").root().packedRows() == 0); // the head has packed numbers itself
    CHECK(printedText("a /-{ - 1 } { - 2 }") == printedText("a { - 2 }"));
    CHECK(printedText("/-a { - 1 }\nb { - 2 }") == printedText("b { - 2 }"));
    CHECK(parseText("a { - 1 } { - 2 }").codes().starts_with("E0124"));
}

TEST_CASE("numbers that were removed again leave no trace in later rows") {
    std::string row, removed;
    for (int i = 0; i < 300; ++i) {
        row += fmt::format(" {}", i);
        removed += fmt::format(" {}.5", i);
    }
    const auto parsed =
        parseText("a 1\n/-b" + removed + "\nc /-2" + row + " mm\nd { /-e" + removed + "; f" + row + " }\n");
    REQUIRE(parsed.diagnostics.all().empty());
    for (const schema::Node node : {parsed.root(1), *parsed.root(2).children().begin()}) {
        REQUIRE(node.valueCount() >= 300);
        for (std::size_t i = 0; i < 300; ++i) CHECK(parsed.sources->text(node.value(i).span) == std::to_string(i));
    }
}

TEST_CASE("packed rows that end with a word, a key or an odd number") {
    for (const char* row : {"a 1 2 3 mm", "a 1 2 3 k=4", "a 1 2 0x10", "a 1 2 k=3 4 5", "a 1 \\ // 7\n 2 3",
                            "a 1 b 2 c 3", "a (u8)1 2", "a 1 (u8)2 3", "a 1 1_0 2"}) {
        const auto parsed = parseText(row);
        CHECK_MESSAGE(parsed.diagnostics.all().empty(), row);
        const schema::Node node = parsed.root();
        for (std::size_t i = 0; i < node.valueCount(); ++i)
            CHECK_MESSAGE(parsed.sources->text(node.value(i).span) == node.value(i).text, row);
    }
    CHECK(printedText("a 1 2 3 k=4 5") == "a 1 2 3 5 k=4\n");
}

TEST_CASE("characters that may not stand in a text") {
    CHECK(parseText(std::string("a \x01 b")).codes() == "E0102@2-3");
    CHECK(parseText(std::string("a b\0c d", 7)).codes() == "E0102@3-4");
    CHECK(parseText("a \u202e\u202e b").codes() == "E0102@2-8");
    CHECK(parseText("a \"\ufeff\"").codes() == "E0102@3-6");
    CHECK(parseText("// \x7f").codes() == "E0102@3-4");
    CHECK(parseText("a \"\\u{202e}\"").codes().empty());
}

TEST_CASE("what is not UTF-8 is one error and no tree") {
    for (const char* bad : {"a \xff b", "a \xc0\x80", "a \xed\xa0\x80", "a \xf4\x90\x80\x80", "a \xe2\x82", "a \x80"}) {
        const auto parsed = parseText(bad);
        CHECK_MESSAGE(parsed.codes() == "E0412@2-3", bad);
        CHECK(parsed.document->roots().empty());
    }
}

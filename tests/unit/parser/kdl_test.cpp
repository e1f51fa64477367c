// The grammar of KDL 2.0.0, construct by construct: what it allows is read, what it forbids is an error. Where scenes
// are stricter, docs/language/syntax.md says why, and a test below that they are.
#include "parse_text.h"

#include <doctest/doctest.h>
#include <utility>

using namespace abbe;
using abbe::test::parseText;
using abbe::test::printedText;

namespace {

struct Accepted {
    const char* source;
    const char* printed;
};

void checkAll(const std::vector<Accepted>& cases) {
    for (const auto& [source, printed] : cases) CHECK_MESSAGE(printedText(source) == printed, std::string(source));
}

// Each of them is refused, by whatever code describes it best.
void checkRefused(const std::vector<const char*>& sources) {
    for (const char* source : sources) CHECK_MESSAGE(parseText(source).diagnostics.hasErrors(), std::string(source));
}

} // namespace

TEST_CASE("KDL: a block needs no space before it") {
    checkAll({{"room{}", "room {\n}\n"},
              {"room7{door}", "room7 {\n    door\n}\n"},
              {"room 7{door}", "room 7 {\n    door\n}\n"},
              {"room 7.5e1{door}", "room 75 {\n    door\n}\n"},
              {"room \"x\"{door}", "room \"x\" {\n    door\n}\n"},
              {"room #\"x\"#{door}", "room \"x\" {\n    door\n}\n"},
              {"room #true{door}", "room #true {\n    door\n}\n"},
              {"room w=3{door}", "room w=3 {\n    door\n}\n"},
              {"room w=\"3\"{door}", "room w=\"3\" {\n    door\n}\n"},
              {"\"room\"{door}", "room {\n    door\n}\n"},
              {"(t)room{door}", "room {\n    door\n}\n"},
              {"room/* c */{door}", "room {\n    door\n}\n"},
              {"a{b{c{d}}}", "a {\n    b {\n        c {\n            d\n        }\n    }\n}\n"}});
}

TEST_CASE("KDL: a slashdash needs no space before it, nor behind it") {
    checkAll({{"row \"x\"/-1", "row \"x\"\n"},
              {"row/-1 2", "row 2\n"},
              {"row 1/-2 3", "row 1 3\n"},
              {"row word/-word", "row word\n"},
              {"row #null/-#null", "row #null\n"},
              {"row k=1/-l=2 m=3", "row k=1 m=3\n"},
              {"row /-1/-2/-3", "row\n"},
              {"row 1/-{ a }", "row 1\n"},
              {"row/-{ a }", "row\n"},
              {"row/-{ a }{ b }", "row {\n    b\n}\n"},
              {"row { a }/-{ b }", "row {\n    a\n}\n"},
              {"row /-{ a }/-{ b } { c }/-{ d }/-{ e }", "row {\n    c\n}\n"},
              {"row 1/-\n/* c */ // d\n2", "row 1\n"},
              {"row { a /-{ b }\n}/-{ c }\nnext", "row {\n    a\n}\nnext\n"},
              {"/-row{a}\nnext", "next\n"},
              {"/-(t)row (u)1\nnext", "next\n"},
              {"row /-(t)1 2", "row 2\n"},
              {"row /-(t)\"x\" 2", "row 2\n"}});
    checkRefused({"row /-/-1", "row /- /- { a }", "/-/-row", "row k=/-1", "row /-k=/-1", "row /-{ a } 1",
                  "row /-{ a } k=1", "row { a } /-1", "row { a /- }", "row /-"});
}

TEST_CASE("KDL: documents and the ends of nodes") {
    checkAll({{"", ""},
              {"\n\r\n \t", ""},
              {"\xef\xbb\xbf", ""},
              {"/* c */", ""},
              {"// c", ""},
              {"a;b;c", "a\nb\nc\n"},
              {"a;\nb", "a\nb\n"},
              {"a// c\nb", "a\nb\n"},
              {"a { b }; c", "a {\n    b\n}\nc\n"},
              {"a { b; c }\nd", "a {\n    b\n    c\n}\nd\n"},
              {"a {\n}\nb", "a {\n}\nb\n"},
              {"/- kdl-version 2\na", "a\n"},
              {"\xef\xbb\xbf/- kdl-version 2\na", "a\n"},
              {"a\\\n1", "a 1\n"},
              {"a \\ // c\n 1 \\\n { b }", "a 1 {\n    b\n}\n"},
              {"a \\", "a\n"},
              {"\\\na", "a\n"}});
    checkRefused({"a { b", "a }", "a { b } c", "a { b } { c }", "a \\ 1", "a /* c", "{ a }", "a ( b", "a [1]"});
}

TEST_CASE("KDL: identifiers") {
    checkAll({{"- -a --1 -.a", "- -a --1 -.a\n"},
              {"- . .a +.a + +a", "- . .a +.a + +a\n"},
              {"a a-1 a.b a:b <a> a|b a*b ~ ! @ % ^ & ?", "a a-1 a.b a:b <a> a|b a*b ~ ! @ % ^ & ?\n"},
              {"a b'c \u00e9 \u6728\u6728 \U0001f600", "a b'c \u00e9 \u6728\u6728 \U0001f600\n"},
              {"a \"true\" \"1\" \"-1\" \"\"", "a \"true\" \"1\" \"-1\" \"\"\n"},
              {"a \"b c\"=1 #\"d\"#=2", "a \"b c\"=1 d=2\n"},
              {"a inf1 nano truest nullify +inf", "a inf1 nano truest nullify +inf\n"}});
    checkRefused({"a true",   "a false", "a null", "a inf", "a -inf", "a nan", "true 1", "a true=1",
                  "(true)a",  "a 1a",    "a -1a",  "a +1a", "a .1",   "a -.1", "a +.1a", "a b#c",
                  "a b\"c\"", "a b[c]",  "a b(c)", "a b/c", "1a",     "a 1=2", "a ==1",  "a k="});
}

TEST_CASE("KDL: quoted texts and their escapes") {
    checkAll({{R"(a "b\n\r\t\\\"\b\f\sc")", "a \"b\\n\\u{d}\t\\\\\\\"\\u{8}\\u{c} c\"\n"},
              {R"(a "\u{41}\u{1F600}\u{00e9}\u{10FFFF}")", "a \"A\U0001f600\u00e9\U0010ffff\"\n"},
              {R"(a "\u{0}")", "a \"\\u{0}\"\n"},
              {"a \"b \\  c\"", "a \"b c\"\n"},
              {"a \"b \\\n   c\"", "a \"b c\"\n"},
              {"a \"b \\\r\n\r\n \t c\"", "a \"b c\"\n"},
              {"a \"// /* no comment */ {};\"", "a \"// /* no comment */ {};\"\n"},
              {"a \"\" #\"\"#", "a \"\" \"\"\n"}});
    checkRefused({"a \"b", "a \"b\nc\"", R"(a "\x")", R"(a "\/")", R"(a "\u{}")", R"(a "\u{1234567}")",
                  R"(a "\u{110000}")", R"(a "\u{d800}")", R"(a "\u{DFFF}")", R"(a "\u41")", R"(a "\u{4g}")",
                  R"(a "b\")", "a \"b\"\"c\"", "a \"b\"c", "a 1\"b\""});
}

TEST_CASE("KDL: raw texts") {
    checkAll({{R"(a #"b\n"#)", "a \"b\\\\n\"\n"},
              {R"(a ##"b"#c"##)", "a \"b\\\"#c\"\n"},
              {R"(a #"b"c"#)", "a \"b\\\"c\"\n"},
              {R"(#"a b"# #"k"#=#"v"#)", "\"a b\" k=\"v\"\n"},
              {R"(a ###"b"##"###)", "a \"b\\\"##\"\n"}});
    checkRefused({R"(a #"b")", R"(a #"b"##)", R"(a ##"b"#)", R"(a "b"#)", "a #\"b\nc\"#", "a r\"b\""});
}

TEST_CASE("KDL: texts of several lines") {
    checkAll({{"a \"\"\"\n  b\n    c\n  \"\"\"", "a \"b\\n  c\"\n"},
              {"a \"\"\"\nb\n\"\"\"", "a \"b\"\n"},
              {"a \"\"\"\n\"\"\"", "a \"\"\n"},
              {"a \"\"\"\n\n\"\"\"", "a \"\"\n"},
              {"a \"\"\"\n  b\n\n   \n  c\n  \"\"\"", "a \"b\\n\\n\\nc\"\n"},
              {"a \"\"\"\r\n  b\r  c\n  \"\"\"", "a \"b\\nc\"\n"},
              {"a \"\"\"\n  b \\\n     c\n  \"\"\"", "a \"b c\"\n"},
              {"a \"\"\"\n  \\n \"\" \\\"\"\" \\u{41}\n  \"\"\"", "a \"\\n \\\"\\\" \\\"\\\"\\\" A\"\n"},
              {"a \"\"\"\n\tb\n\t\tc\n\t\"\"\"", "a \"b\\n\tc\"\n"},
              {"a #\"\"\"\n  b \\n \"\"\"\n  \"\"\"#", "a \"b \\\\n \\\"\\\"\\\"\"\n"},
              {"a ##\"\"\"\n  b \"\"\"#\n  \"\"\"##{ c }", "a \"b \\\"\\\"\\\"#\" {\n    c\n}\n"},
              {"\"\"\"\n  a\n  \"\"\" k=\"\"\"\n  b\n  \"\"\"", "a k=\"b\"\n"}});
    checkRefused({"a \"\"\"b\"\"\"", "a \"\"\"\nb\"\"\"", "a \"\"\"\n b\n  \"\"\"", "a \"\"\"\n\tb\n  \"\"\"",
                  "a \"\"\"\n  b", "a #\"\"\"\n  b\n  \"\"\"", "a #\"\"\"b\"\"\"#", "a \"\"\"\n  b \"\"\""});
}

TEST_CASE("KDL: numbers") {
    checkAll({{"a 0 -0 +0 00 007", "a 0 -0 0 0 7\n"},
              {"a 1_000 1_ 1__0 0.1_5 1e1_0", "a 1000 1 10 0.15 10000000000\n"},
              {"a 1.5 -1.5 +1.5 1.5e2 1.5E2 1.5e+2 1.5e-2 2e2", "a 1.5 -1.5 1.5 150 150 150 0.015 200\n"},
              {"a 0xaF 0xA_f 0o17 0o1_7 0b101 0b1_0", "a 175 175 15 15 5 2\n"},
              {"a -0xff +0b1 -0o7 0x0123456789abcdef", "a -255 1 -7 8.19855292164869e+16\n"},
              {"a 1e-1000 -1e-1000 1.23E-1000", "a 0 -0 0\n"},
              {"a #inf #-inf #nan k=#inf", "a #inf #-inf #nan k=#inf\n"}});
    checkRefused({"a 1.", "a 1._0", "a 1.0.0", "a .5", "a 1e", "a 1e+", "a 1e_1", "a 0x", "a 0x_f", "a 0xg", "a 0o8",
                  "a 0b2", "a 0b_1", "a 1.5e1.5", "a 0x1.5"});
}

TEST_CASE("KDL: keywords and type annotations") {
    checkAll({{"a #true #false #null k=#null", "a #true #false #null k=#null\n"},
              {"(t)a (u)1 (u)#true (u)\"b\" (u)#\"b\"# (u)b k=(u)1", "a 1 #true \"b\" \"b\" b k=1\n"},
              {"( t )a (\"t u\") 1 (#\"t\"#)2 (/* c */t)3", "a 1 2 3\n"},
              {"(t)\\\na (t)/* c */1", "a 1\n"},
              {"(-)a (.)1", "a 1\n"}});
    checkRefused({"a #yes", "a #TRUE", "a #", "a #inf1", "()a", "(1)a", "(t u)a", "(t", "(t)", "a (t)", "a ()1",
                  "a (t)k=1", "a k(t)=1", "a 1(t)", "a (#true)1", "a (t)(u)1", "a k=(t)", "(t)=1"});
}

TEST_CASE("KDL: white space, line ends and characters that may stand nowhere") {
    for (const char* blank : {"\t", " ", "\u00a0", "\u1680", "\u2000", "\u2001", "\u2002", "\u2003", "\u2004", "\u2005",
                              "\u2006", "\u2007", "\u2008", "\u2009", "\u200a", "\u202f", "\u205f", "\u3000"})
        CHECK_MESSAGE(printedText(std::string("a") + blank + "1") == "a 1\n", blank);
    for (const char* newline : {"\r\n", "\r", "\n", "\u0085", "\v", "\f", "\u2028", "\u2029"}) {
        CHECK(printedText(std::string("a // c") + newline + "b") == "a\nb\n");
        CHECK(printedText(std::string("a \\") + newline + "1") == "a 1\n");
        CHECK_MESSAGE(parseText(std::string("a \"b") + newline + "c\"").diagnostics.hasErrors(), newline);
    }
    for (const char* odd : {"\x01", "\x08", "\x0e", "\x1f", "\x7f", "\u200e", "\u200f", "\u202a", "\u202e", "\u2066",
                            "\u2069", "\ufeff", "\xed\xa0\x80", "\xc0\x80", "\xff"})
        for (const char* before : {"a ", "a \"", "a #\"", "// ", "/* "})
            CHECK_MESSAGE(parseText(before + std::string(odd)).diagnostics.hasErrors(), before);
    CHECK(parseText(std::string("a\0b", 3)).diagnostics.hasErrors());
}

TEST_CASE("rules of scenes that are stricter than KDL") {
    CHECK(parseText("a b,c").codes() == "E0112@3-4");
    CHECK(parseText("a ,").codes() == "E0112@2-3");
    CHECK(parseText("a 'b").codes() == "E0114@2-4");
    CHECK(parseText("a \u201cb").codes() == "E0114@2-6");
    CHECK(parseText("a 1.23E+1000").codes() == "E0118@2-12");
    CHECK(parseText("a -1.23E+1000").codes() == "E0118@2-13");
    CHECK(parseText("param a 1\nb $a").printed() == "b 1\n");
    CHECK(parseText("b $a").codes() == "E0204@2-4");
    CHECK(parseText(";; a;;;\nb { ; }").codes() == "E0128@0-2 E0128@5-7 E0128@12-13");
    CHECK(parseText("a { };\n} ;\n/-;").codes() == "E0111@7-8 E0122@11-13"); // no more than one each
    std::string deep;
    for (int i = 0; i < 257; ++i) deep += "a{";
    CHECK(parseText(deep + std::string(257, '}')).errors().find("E0119") != std::string::npos);
}

// KDL 2.0.0, clause by clause: documents that the specification accepts and documents that it refuses. Names of the
// clauses are those of its grammar. What is read from the accepted ones is tested in tests/unit/parser/kdl_test.cpp.
#include "base/text.h"
#include "kdl_documents.h"
#include "language_fixture.h"
#include "support/print_document.h"

#include <cmath>
#include <cstdlib>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <initializer_list>

using namespace language_test;

namespace {

struct ReadKdl {
    SourceMap sources;
    Diagnostics diagnostics;
    std::shared_ptr<schema::Document> document;

    explicit ReadKdl(std::string text) {
        // No text of a scene reaches the parser before it was found to be UTF-8.
        document = parse(sources, sources.add("test.scene", std::move(text)), {}, diagnostics);
    }
    // Of the syntax: parameters are a matter of scenes.
    std::string codes() const {
        std::string list;
        for (const Diagnostic& d : diagnostics.all())
            if (d.code.starts_with("E01") || d.code == "E0412") list += (list.empty() ? "" : " ") + d.code;
        return list;
    }
};

std::size_t checkedCases = 0;

using Texts = std::initializer_list<std::string>;

void good(const Texts& texts) {
    for (const std::string& text : texts) {
        const ReadKdl read(text);
        CHECK_MESSAGE(read.codes().empty(), "accepted by KDL: " << text << ": " << read.codes());
        ++checkedCases;
    }
}

void bad(const Texts& texts) {
    for (const std::string& text : texts) {
        CHECK_MESSAGE(!ReadKdl(text).codes().empty(), "refused by KDL: " << text);
        ++checkedCases;
    }
}

} // namespace

TEST_CASE("KDL: document, nodes, node-terminator") {
    good({"",
          " ",
          "\n",
          "node",
          "node\n",
          "node;",
          "node; ",
          "node;node",
          "node ;node",
          "node\n\n\nnode",
          "node // c",
          "node //",
          "// c\nnode",
          "//\nnode",
          "/* c */ node",
          "/* c */\nnode",
          "node /* c */",
          "node /* c */;",
          "node\r\nnode",
          "node\rnode",
          "\\\nnode",
          "\\ // c\nnode",
          "\\",
          "node \\",
          "\xef\xbb\xbfnode",
          "\xef\xbb\xbf// c",
          "/- kdl-version 2\nnode",
          "\xef\xbb\xbf/- kdl-version 2\nnode",
          "/- kdl-version 1\nnode",
          "node 1;\n"});
}

TEST_CASE("KDL: a semicolon ends a node, and there are no empty ones") {
    good({"a;", "a;b;", "a{};", "a{b;};c", "a /-{b};", "a\\\n;", "a/* c */;", "a{b;c}", "/-a;", "/-a;b"});
    bad({";", ";;", "a;;", "a;;b", "; a", "\n;", "a\n;", "a;\n;", "{;}", "a {;}", "a { ; b }", "a { b;; }", "a{};;",
         "a;/* c */;", "// c\n;", "/-;", "/- ;a"});
}

TEST_CASE("KDL: base-node, its name") {
    good({"- 1",
          "-- 1",
          "+",
          "-",
          ".",
          "-.",
          "+.",
          "..",
          ".a",
          "-.a",
          "-a",
          "+a",
          "..1",
          "-..1",
          "--1",
          "+-1",
          "-+1",
          "a1",
          "_1",
          "~",
          "!",
          "@x",
          "a.b",
          "a:b",
          "a-b",
          "a+b",
          "<a>",
          "a<b",
          "a|b",
          "a*b",
          "a&b",
          "a%b",
          "a^b",
          "a`b",
          "a$b",
          "a?b",
          "\u6728",
          "\u00e9t\u00e9",
          "\U0001f600",
          "\u2460",
          "\u0661",
          "truex",
          "xtrue",
          "nullnull",
          "inf-",
          "-infx",
          "+inf",
          "-nan",
          "+true",
          "-null",
          "True",
          "NULL",
          "\"a b\" 1",
          "\"\" 1",
          "\"true\"",
          "\"1\"",
          "#\"a\"# 1",
          "\"\"\"\n\"\"\" 1",
          "\"\"\"\n  a\n  \"\"\"",
          "#\"\"\"\na\n\"\"\"# 1"});
    bad({"1",      "1a",     "-1",         "+1",   "-1a",      ".1",      "-.1",  "+.1",     ".1a",   "-.1a",
         "0x1",    "true",   "false",      "null", "inf",      "-inf",    "nan",  "#true",   "#null", "#inf",
         "#a",     "#",      "=",          "=1",   "a=1",      "\"a\"=1", "a(b)", "a[b]",    "a]",    "a)",
         "a\"b\"", "\"a\"b", "\"a\"\"b\"", "a#b",  "a/b",      "a\\b",    "[a]",  "(a)",     "(a)1",  "(a)#true",
         "{}",     "{ a }",  "/",          "a b/", "#\"a\"#b", "#\"a\"",  "\"a",  "\"a\nb\""});
}

TEST_CASE("KDL: node-prop-or-arg, prop") {
    good({"a b",
          "a b c",
          "a 1 b #true \"c\" #\"d\"#",
          "a k=1",
          "a k=v",
          "a k=\"v\"",
          "a \"k\"=1",
          "a #\"k\"#=1",
          "a k=#null",
          "a k=-1",
          "a k =1",
          "a k= 1",
          "a k = 1",
          "a k\\\n=\\\n1",
          "a k/* c */=/* c */1",
          "a k\t=\t1",
          "a 1 k=1 2",
          "a k=1 k=2",
          "a k=1 \"k\"=2",
          "a -=1",
          "a .=1",
          "a +k=1",
          "a k=-",
          "a k=.",
          "a k=(t)1",
          "a k=(t) 1",
          "a k=( t )v",
          "a k = (t) \"v\"",
          "a \"\"=1",
          "a \"a b\"=1",
          "a \"\"\"\nk\n\"\"\"=1",
          "a k=\"\"\"\nv\n\"\"\"",
          "a\\\nb",
          "a \\\n b",
          "a\\ // c\nb",
          "a\\ /* c */ // d\nb",
          "a /* c */ b",
          "a/* c */b",
          "a 1/* c */2",
          "a \"b\"/* c */\"c\"",
          "a \\\n\\\nb",
          "a \\"});
    bad({"a k=",         "a k=;",     "a k=\n1",
         "a =1",         "a = 1",     "a =",
         "a k==1",       "a k=1=2",   "a 1=2",
         "a -1=2",       "a #true=1", "a true=1",
         "a (t)k=1",     "a k=l=1",   "a k=1\"b\"",
         "a \"k\"\"v\"", "a 1\"b\"",  "a \"b\"1",
         "a \"b\"k=1",   "a k={}",    "a k=}",
         "a k=/-1",      "a k/-=1",   "a #true#false",
         "a #true\"b\"", "a 1#true",  "a #\"b\"##\"c\"#",
         "a \\ b",       "a \\b",     "a b\\c",
         "a k=(t)",      "a k=()1",   "a [1]",
         "a [",          "a ]",       "a (",
         "a )",          "a (1 2)",   "a b=true",
         "a k=nan",      "a .5",      "a 1.",
         "a \n=1"});
}

TEST_CASE("KDL: node-children, final-node") {
    good({"a {}",
          "a{}",
          "a { }",
          "a {\n}",
          "a { b }",
          "a {b}",
          "a {b;}",
          "a { b; c }",
          "a { b\nc\n}",
          "a {\nb\n}",
          "a { b { c { d } } }",
          "a { b {} }\nc",
          "a {} // c",
          "a {} /* c */",
          "a { // c\n}",
          "a { /* c */ }",
          "a { b // c\n}",
          "a { b /* c */ }",
          "a { \\\n b }",
          "a \\\n{ b }",
          "a 1{}",
          "a k=1{}",
          "a \"b\"{}",
          "a #true{}",
          "a /* c */{}",
          "a {b}\n",
          "a { (t)b }",
          "a { - 1; - 2 }",
          "a { b 1 }",
          "a { /-b }",
          "a { /-b\n }"});
    bad({"a {",       "a { b",     "a { b {}",   "a }",        "}",          "a {}}",     "a {} b",  "a {} 1",
         "a {} {}",   "a {}{}",    "a {}k=1",    "a\n{}",      "a\n{ b }",   "a;{}",      "a { 1 }", "a { {} }",
         "a {} (t)b", "a { b } c", "a { b c= }", "a { b \\ }", "a { // c }", "a { /* c }"});
}

TEST_CASE("KDL: type") {
    good({"(t)a",
          "( t )a",
          "(t) a",
          "(t)\ta",
          "(t)/* c */a",
          "(t)\\\na",
          "(/* c */t/* d */)a",
          "(\\\nt)a",
          "(\"t\")a",
          "(\"t u\")a",
          "(#\"t\"#)a",
          "(\"\")a",
          "(-)a",
          "(.)a",
          "(\"\"\"\nt\n\"\"\")a",
          "a (t)1",
          "a (t) 1",
          "a (t)b",
          "a (t)\"b\"",
          "a (t)#true",
          "a (t)#inf",
          "a (t)#\"b\"#",
          "a (t)-1",
          "a ( t ) 1",
          "a (t)1 (u)2",
          "(t)\"a\"",
          "(t)#\"a\"#",
          "(t)a (u)b k=(v)c { (w)d }",
          "(a-b.c)d",
          "(t)- 1"});
    bad({"()a",    "( )a",     "(1)a",      "(#true)a", "(#null)a",  "(true)a", "(t u)a",   "(t)",
         "(t)\na", "(t);",     "(t){}",     "(t)(u)a",  "((t))a",    "(t a",    "t)a",      "a (t)",
         "a (t);", "a (t){}",  "a (t) k=1", "a (t)k=1", "a (t)(u)1", "a 1(t)",  "a (t)/-1", "(t)/-a",
         "(t)=1",  "(t k=1)a", "(.1)a",     "(t\nu)a",  "(t,)a",     "a b(t)"});
}

TEST_CASE("KDL: slashdash") {
    good({"/-a",
          "/- a",
          "/-\na",
          "/-\n\na",
          "/-/* c */a",
          "/-// c\na",
          "/-\\\na",
          "/-(t)a",
          "/- (t) a",
          "/-a b c=1 { d }\ne",
          "/-a { b }",
          "/-\"a b\"",
          "a /-1",
          "a /- 1",
          "a/-1",
          "a /-\n1",
          "a /-\n1 2",
          "a /-// c\n1",
          "a /-b=1",
          "a /-b = 1",
          "a /- b=(t)1",
          "a 1/-2",
          "a \"b\"/-\"c\"",
          "a /-1 /-2",
          "a/-1/-2",
          "a /-(t)1",
          "a /-{}",
          "a/-{}",
          "a /-{ b } { c }",
          "a { b } /-{ c }",
          "a {}/-{}",
          "a /-{}/-{}",
          "a /-{} {} /-{} /-{}",
          "a /- { b }",
          "a /-\n{ b }",
          "a 1 /-{}",
          "a /-1 {}",
          "a /-1 /-{}",
          "a { /-b; c }",
          "a { /-b }",
          "/-a;b",
          "/-a // c\nb",
          "a /-{ b } // c",
          "a /-{};b",
          "a b /-c d",
          "/-- 1",
          "/-/*c*/ /*d*/ a",
          "a /-#true",
          "a /-#\"b\"#",
          "a /-\"\"\"\nb\n\"\"\"",
          "a /-k=\"v\" 1"});
    bad({"/-",         "/- ",        "/-\n",     "/- // c",    "a /-",         "a /- ",        "a /-\n",    "a /-;",
         "a { /- }",   "a { /-}",    "a /-}",    "/-/-a",      "/- /-a",       "a /-/-1",      "a /- /- 1", "a /-{} 1",
         "a /-{} k=1", "a /-{} /-1", "a {} /-1", "a {} /-k=1", "a {} {} /-{}", "a /-{} {} {}", "a k=/-1",   "a k/-=1",
         "a (t)/-1",   "(t)/-a",     "/-1",      "/-#true",    "/-{}",         "/- { a }",     "/-a b=",    "a /-b=",
         "/-a {",      "a /-{",      "a /-{ b",  "/-a {} 1",   "a /-1a",       "a /-true"});
}

TEST_CASE("KDL: quoted-string") {
    good({R"(a "")",
          R"(a "b")",
          R"(a "b c")",
          R"(a "b\tc")",
          R"(a "\n\r\t\\\"\b\f\s")",
          R"(a "\u{0}")",
          R"(a "\u{41}")",
          R"(a "\u{000041}")",
          R"(a "\u{10FFFF}")",
          R"(a "\u{10ffff}")",
          R"(a "\u{D7FF}")",
          R"(a "\u{E000}")",
          R"(a "\u{fffe}")",
          R"(a "\u{200E}")",
          R"(a "\u{FEFF}")",
          R"(a "b\   c")",
          R"(a "\ ")",
          R"(a "#")",
          R"(a "'")",
          R"(a "{};=()[]/,")",
          R"(a "// c")",
          R"(a "/* c")",
          R"(a "\"")",
          R"(a "\\")",
          "a \"b\\\n   c\"",
          "a \"b\\\r\n\r\n c\"",
          "a \"b\\ \t\n c\"",
          "a \"\\\n\"",
          "a \"\t\"",
          "a \"\u3000\"",
          "a \"b\\\u3000c\"",
          "a \"b\\\u2028c\"",
          "a \"\u00e9\U0001f600\""});
    bad({R"(a ")",          R"(a "b)",         R"(a "b\")",          R"(a "\x")",          R"(a "\/")",
         R"(a "\a")",       R"(a "\0")",       R"(a "\'")",          R"(a "\N")",          R"(a "\u")",
         R"(a "\u41")",     R"(a "\u{}")",     R"(a "\u{1234567}")", R"(a "\u{0000041}")", R"(a "\u{110000}")",
         R"(a "\u{D800}")", R"(a "\u{dfff}")", R"(a "\u{0D800}")",   R"(a "\u{g}")",       R"(a "\u{4 1}")",
         R"(a "\u{41")",    R"(a "\u{-1}")",   R"(a "\U{41}")",      R"(a "\u {41}")",     "a \"b\nc\"",
         "a \"b\rc\"",      "a \"b\vc\"",      "a \"b\u2028c\"",     "a \"b\u0085c\"",     "a \"b\n\"",
         "a \"b\\ c\nd\"",  R"(a "b"c")",      R"(a "b""")"});
}

TEST_CASE("KDL: multi-line strings") {
    good({"a \"\"\"\n\"\"\"",
          "a \"\"\"\n\n\"\"\"",
          "a \"\"\"\nb\n\"\"\"",
          "a \"\"\"\n  b\n  \"\"\"",
          "a \"\"\"\n    b\n  \"\"\"",
          "a \"\"\"\n\n  b\n\n  \"\"\"",
          "a \"\"\"\n \n  b\n  \"\"\"",
          "a \"\"\"\n\t\n  b\n  \"\"\"",
          "a \"\"\"\r\n  b\r\n  \"\"\"",
          "a \"\"\"\r  b\n  \"\"\"",
          "a \"\"\"\n\tb\n\t\"\"\"",
          "a \"\"\"\n  \"b\"\n  \"\"\"",
          "a \"\"\"\n  \"\"b\"\"\n  \"\"\"",
          "a \"\"\"\n  \\\"\"\"\n  \"\"\"",
          "a \"\"\"\n  \\n\n  \"\"\"",
          "a \"\"\"\n  b \\\n  c\n  \"\"\"",
          "a \"\"\"\n  b \\\nc\n  \"\"\"",
          "a \"\"\"\n  b\n  \\   \"\"\"",
          "a \"\"\"\n\\\n\"\"\"",
          "a \"\"\"\n  b\n\\  \"\"\"",
          "a #\"\"\"\n  b\n  \"\"\"#",
          "a #\"\"\"\n\"\"\"#",
          "a ##\"\"\"\n  \"\"\"#\n  \"\"\"##",
          "a #\"\"\"\n  \\n\n  \"\"\"#",
          "a #\"\"\"\n  \"\"\"\n  \"\"\"#",
          "a \"\"\"\n  b\n  \"\"\" c",
          "a \"\"\"\n  b\n  \"\"\"{}",
          "a \"\"\"\n  \\s\n  \"\"\"",
          "a \"\"\"\n\u3000b\n\u3000\"\"\"",
          "a \"\"\"\u0085 b\u2029 \"\"\""});
    bad({"a \"\"\"\"\"\"",
         "a \"\"\"b\"\"\"",
         "a \"\"\" \n\"\"\"",
         "a \"\"\"b\n\"\"\"",
         "a \"\"\"\nb\"\"\"",
         "a \"\"\"\n  b\n c\n  \"\"\"",
         "a \"\"\"\n\tb\n  \"\"\"",
         "a \"\"\"\n  b\n\tc\n  \"\"\"",
         "a \"\"\"\n  b",
         "a \"\"\"\n  b\n  \"\"",
         "a \"\"\"\n  b\\\n  \"\"\"",
         "a \"\"\"\n  \\x\n  \"\"\"",
         "a \"\"\"\n  b \"\"\"",
         "a #\"\"\"#",
         "a #\"\"\"\"\"\"#",
         "a #\"\"\"b\"\"\"#",
         "a #\"\"\"\nb\"\"\"#",
         "a #\"\"\"\n b\n  \"\"\"#",
         "a #\"\"\"\n  b\n  \"\"\"",
         "a ##\"\"\"\n  b\n  \"\"\"#",
         "a #\"\"\"\n  b\\\n  c\n \\ \"\"\"#",
         "a \"\"\"\n  \"\"\"\"",
         "a \"\"\"\\\n\"\"\"",
         "a \"\"\"\nb\n\\s\"\"\""});
}

TEST_CASE("KDL: raw-string") {
    good({R"(a #""#)",       R"(a #"b"#)",    R"(a ##"b"##)",       R"(a #"\n"#)",  R"(a #"\"#)",   R"(a #"b"c"#)",
          R"(a ##"b"#c"##)", R"(a ##"#"##)",  R"(a ###"b"##c"###)", R"(a #" "#)",   R"(a #"b" "#)", R"(a ##""b"##)",
          R"(a #"b"# c)",    R"(a #"b"#;c)",  R"(a #"b"#{})",       R"(a k=#"b"#)", R"(a #"k"#=1)", R"(a #"'"#)",
          R"(a #"\u{zz}"#)", R"(a #"// c"#)", R"(a ##""##)"});
    bad({R"(a #"b)", R"(a #"b")", R"(a ##"b"#)", R"(a #"b"##)", R"(a #"b"#c)", R"(a r"b")", R"(a r#"b"#)",
         R"(a # "b"#)", "a #\"b\nc\"#", "a #\"b\\\nc\"#", R"(a "b"#)", R"(a #b#)", R"(a #"b"#"c")", "a ##\"b\"#\n",
         "a #\"\x7f\"#", "a #\"\u200e\"#"});
}

TEST_CASE("KDL: number") {
    good({"a 0",
          "a 00",
          "a 1",
          "a -1",
          "a +1",
          "a -0",
          "a 1_0",
          "a 1_",
          "a 1__",
          "a 0_0",
          "a 1.0",
          "a 1.0_0",
          "a 1_.0_",
          "a 1e1",
          "a 1E1",
          "a 1e+1",
          "a 1e-1",
          "a 1e1_0",
          "a 1e1_",
          "a 1.5e3",
          "a -1.5E-3",
          "a +1.5e+3",
          "a 1_0.5_0e1_0",
          "a 0x0",
          "a 0xF",
          "a 0xf",
          "a 0xaB_c",
          "a 0x0_",
          "a -0x1",
          "a +0x1",
          "a 0o0",
          "a 0o17_7",
          "a -0o7",
          "a 0b0",
          "a 0b1_0",
          "a +0b1",
          "a 0x1e1",
          "a #inf",
          "a #-inf",
          "a #nan",
          "a 1e-400",
          "a 0e999",
          "a 123456789012345678901234567890",
          "a 1;b",
          "a 1{}",
          "a 1/-2",
          "a 1/* c */",
          "a 1// c"});
    bad({"a 1.",    "a .1",    "a -.1",   "a 1._0", "a 1.e1", "a 1e",    "a 1e+",  "a 1e_1", "a 1e+_1",
         "a 1.5.5", "a 1e1.5", "a 1e1e1", "a 1a",   "a 1_a",  "a 1-1",   "a 1+1",  "a 0x",   "a 0x_",
         "a 0x_1",  "a 0xg",   "a 0x1g",  "a 0X1",  "a 0x-1", "a 0x1.5", "a 0o",   "a 0o8",  "a 0o_1",
         "a 0O1",   "a 0b",    "a 0b2",   "a 0b_1", "a 0B1",  "a --1a=", "a +-1=", "a 1,5,", "a #+inf",
         "a #Inf",  "a #infx", "a #-nan", "a #1",   "a inf",  "a -inf",  "a nan",  "a 1=1",  "a 1\\2"});
}

TEST_CASE("KDL: keywords") {
    good({"a #true", "a #false", "a #null", "a #true #false", "a k=#true", "a #true{}", "a #true;b", "a #true/* c */",
          "a #true// c", "a #true\\\n1", "a #null/-1"});
    bad({"a true", "a false", "a null", "a #True", "a #TRUE", "a #truex", "a #true1", "a #true_", "a #on", "a #",
         "a # true", "a ##true", "a #\n", "a #nul", "a #true(t)", "#true 1", "a k=null", "(false)a"});
}

TEST_CASE("KDL: ws, newline, comments") {
    for (const char* blank : {"\t", " ", "\u00a0", "\u1680", "\u2000", "\u2001", "\u2002", "\u2003", "\u2004", "\u2005",
                              "\u2006", "\u2007", "\u2008", "\u2009", "\u200a", "\u202f", "\u205f", "\u3000"})
        good({std::string("a") + blank + "1", std::string(blank) + "a" + blank});
    for (const char* newline : {"\r\n", "\r", "\n", "\u0085", "\v", "\f", "\u2028", "\u2029"}) {
        good({std::string("a") + newline + "b", std::string("a // c") + newline + "b",
              std::string("a \\") + newline + "1"});
        bad({std::string("a") + newline + "1", std::string("a \"") + newline + "\""});
    }
    good({"a /**/ 1", "a /***/ 1", "a /* * / */ 1", "a /*/**/*/ 1", "a /* /* */ /* */ */ 1", "a /*\n*/ 1",
          "a /* \" */ 1", "a /* // */ 1", "a /* { */", "//", "///", "// /*", "a //\u00e9", "/**/", "/*\n\n*/a",
          "a\u200b", "\u180ea", "a\u2060b"});
    bad({"/*", "a /*", "a /*/", "a /* /* */", "a /* */ */", "*/ 1/", "/* // */ */ 1 /", "a / 1", "a /1", "/ a",
         "/ / a"});
}

TEST_CASE("KDL: disallowed-literal-code-points, and UTF-8") {
    for (const char* odd : {"\x01",   "\x02",   "\x03",   "\x04",   "\x05",   "\x06",   "\x07",   "\x08",   "\x0e",
                            "\x0f",   "\x10",   "\x1b",   "\x1f",   "\x7f",   "\u200e", "\u200f", "\u202a", "\u202b",
                            "\u202c", "\u202d", "\u202e", "\u2066", "\u2067", "\u2068", "\u2069", "\ufeff"})
        bad({std::string("a") + odd, std::string("a \"") + odd + "\"", std::string("// ") + odd,
             std::string("a #\"") + odd + "\"#", std::string("/*") + odd + "*/",
             std::string("\"\"\"\n") + odd + "\n\"\"\""});
    bad({std::string("a\0", 2), std::string("// \0", 4), "a \xff", "a \"\xc0\x80\"", "a \"\xed\xa0\x80\"",
         "// \xf4\x90\x80\x80", "a \xe2\x82", "\xef\xbb\xbf\xef\xbb\xbf"});
    good({"a \"\u0080\"", "a \u0081", "a \ufffe", "a \U0010ffff", "a \u200d", "a \u2065"});
}

TEST_CASE("KDL: there are enough cases") { CHECK(checkedCases > 900); }

TEST_CASE("KDL: documents of the grammar are accepted, and laid out once for all") {
    constexpr std::uint32_t count = 12'000;
    std::size_t accepted = 0, faults = 0;
    for (std::uint32_t i = 0; i < count && faults < 40; ++i) {
        const std::string text = kdlDocument(i);
        const ReadKdl read(text);
        const bool good = read.codes().empty();
        accepted += good;
        const auto fail = [&](const std::string& what) {
            ++faults;
            FAIL_CHECK("document " << i << " " << what << ": " << abbe::jsonText(text) << " " << read.codes() << " -> "
                                   << abbe::jsonText(layOut(text)));
        };
        if (i % 2 == 0 && !good) fail("is refused");
        if (!good) continue;
        const std::string once = layOut(text);
        const ReadKdl again(once);
        if (!again.codes().empty()) fail("has no layout without errors");
        if (!sameMeaning(*read.document, *again.document)) fail("means something else when it is laid out");
        if (layOut(once) != once) fail("is laid out differently the second time");
    }
    CHECK(accepted > count * 11 / 20);
    CHECK(accepted < count * 9 / 10);
}

namespace {

std::string jsonValue(const Value& value) {
    switch (value.kind) {
    case ValueKind::number:
        if (std::isfinite(value.number)) return fmt::format("{{\"number\":{}}}", value.number);
        return fmt::format("{{\"number\":\"{}\"}}", std::isnan(value.number) ? "nan"
                                                    : value.number > 0       ? "inf"
                                                                             : "-inf");
    case ValueKind::boolean:
        return value.boolean ? "true" : "false";
    case ValueKind::null:
        return "null";
    default:
        return jsonText(value.text);
    }
}

std::string jsonNodes(NodeRange nodes) {
    std::string out = "[";
    for (const Node node : nodes) {
        std::string values, keys;
        for (std::size_t i = 0; i < node.valueCount(); ++i) values += (i > 0 ? "," : "") + jsonValue(node.value(i));
        for (const Key& key : node.keys())
            keys += (keys.empty() ? "" : ",") + jsonText(key.name) + ":" + jsonValue(key.value);
        out += fmt::format("{}[{},[{}],{{{}}},{}]", out.size() > 1 ? "," : "", jsonText(node.name()), values, keys,
                           jsonNodes(node.children()));
    }
    return out + "]";
}

} // namespace

// For kdl_peers.py: the documents, what is wrong with each, and what was read, a line of JSON each.
TEST_CASE("KDL: documents for other implementations") {
    const char* const path = std::getenv("ABBE_KDL_DOCUMENTS");
    if (path == nullptr) return;
    std::ofstream out(path, std::ios::binary);
    for (std::uint32_t i = 0; i < 12'000; ++i) {
        const std::string text = kdlDocument(i);
        const ReadKdl read(text);
        out << fmt::format("{{\"text\":{},\"codes\":\"{}\",\"nodes\":{}}}\n", jsonText(text), read.codes(),
                           read.codes().empty() ? jsonNodes(read.document->roots()) : "null");
    }
    CHECK(out.good());
}

// The layout of scene files: each rule of docs/language/syntax.md, "Layout", and that nothing else changes.
#include "parse_text.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

using namespace abbe;
using abbe::test::parseText;

namespace {

// The layout of a text without errors, which is checked to be final and to mean the same.
std::string laidOut(const std::string& text) {
    const std::string once = layOut(text);
    const auto before = parseText(text), after = parseText(once);
    CHECK_MESSAGE(!before.diagnostics.hasErrors(), text << ": " << before.errors());
    CHECK_MESSAGE(!after.diagnostics.hasErrors(), once << ": " << after.errors());
    CHECK_MESSAGE(sameMeaning(*before.document, *after.document), once);
    CHECK(layOut(once) == once);
    return once;
}

using Cases = std::vector<std::pair<std::string, std::string>>;

void checkLaidOut(const Cases& cases) {
    for (const auto& [text, expected] : cases) CHECK(laidOut(text) == expected);
}

void checkKept(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) CHECK(laidOut(text) == text);
}

const std::string kLong(60, 'x'); // two of them are too long for a line

} // namespace

TEST_CASE("layout: a node a line, four spaces a level") {
    checkLaidOut({{"a;b;c", "a\nb\nc\n"},
                  {"  a\n\t b", "a\nb\n"},
                  {"a {\nb {\nc\n}\n}", "a {\n    b {\n        c\n    }\n}\n"},
                  {"a { b\nc }", "a {\n    b\n    c\n}\n"},
                  {"a {\n\n}", "a {\n}\n"},
                  {"a { b }; c", "a { b }\nc\n"},
                  {"a 1;\nb;", "a 1\nb\n"},
                  {"a 1  \t\nb\u3000\n", "a 1\nb\n"},
                  {"", ""},
                  {"\n \n", ""}});
}

TEST_CASE("layout: at most one empty line, and none at the edges of a block") {
    checkLaidOut({{"\n\na\n\n\n\nb\n\n", "a\n\nb\n"},
                  {"a {\n\n  b\n \n\n  c\n\n}", "a {\n    b\n\n    c\n}\n"},
                  {"// c\n\n\n// d\na", "// c\n\n// d\na\n"},
                  {"a {\n    // c\n\n}", "a {\n    // c\n}\n"}});
}

TEST_CASE("layout: blocks of one line stay, with spaces inside of their braces") {
    checkLaidOut({{"a{b;c 1}", "a { b; c 1 }\n"},
                  {"a {b;c;}", "a { b; c }\n"},
                  {"a { b ; }", "a { b }\n"},
                  {"a{b{c}}", "a { b { c } }\n"},
                  {"a{}", "a {}\n"},
                  {"a /-{b}{c}/-{d}", "a /-{ b } { c }/-{ d }\n"},
                  {"a    {\nb\n}\nc \\\n    {\nd\n}", "a {\n    b\n}\nc \\\n    {\n    d\n}\n"},
                  {"a /- { b } { c }", "a /- { b } { c }\n"}});
    checkKept({"a { }\n", "floor      quad { material white;   points 0 0   1 1 }\n", "a { /* c */ b }\n"});
}

TEST_CASE("layout: blocks that are too long for a line are opened, but for what was aligned by hand") {
    const std::string two = kLong + "; " + kLong, three = kLong + ";  " + kLong;
    CHECK(laidOut("a { " + two + " }") == "a {\n    " + kLong + "\n    " + kLong + "\n}\n");
    checkKept({"a { " + three + " }\n"});
    // Exactly a hundred columns, whatever the bytes.
    const std::string name(92, 'y');
    checkKept({"a { " + name + "zz }\n"});
    CHECK(laidOut("a { " + name + "zzz }") == "a {\n    " + name + "zzz\n}\n");
    std::string wide;
    for (int i = 0; i < 94; ++i) wide += "\u6728";
    checkKept({"a { " + wide + " }\n"});
    // The inner block may fit once it has a line of its own.
    CHECK(laidOut("a { b { c }; d { " + kLong + " }; e { " + kLong + " } }") ==
          "a {\n    b { c }\n    d { " + kLong + " }\n    e { " + kLong + " }\n}\n");
    checkKept({kLong + kLong + " {}\n"});
}

TEST_CASE("layout: rows stay together as far as a line goes") {
    checkKept({"points {\n    - -1 0 0;  - 1 0 0;  - 0 1 0\n    - -1 0 1;  - 1 0 1\n}\n",
               "ramp {\n    stop 0.1 a; stop 0.2 b\n    stop 0.3 c\n}\n"});
    checkLaidOut({{"points { - 1 2; - 3 4;\n- 5 6 }", "points {\n    - 1 2; - 3 4\n    - 5 6\n}\n"},
                  {"a {\n  b 1; c 2\n}", "a {\n    b 1\n    c 2\n}\n"},
                  {"a {\n  b 1; b { c }\n}", "a {\n    b 1\n    b { c }\n}\n"}});
    std::string rows, wrapped;
    for (int i = 0; i < 30; ++i) rows += fmt::format("{}- {} 0 1", i > 0 ? "; " : "", 10 + i);
    const std::string laid = laidOut("points { " + rows + " }");
    CHECK(laid.starts_with("points {\n    - 10 0 1; - 11 0 1; "));
    CHECK(std::ranges::count(laid, '\n') == 6);
    for (const auto line : {0, 1}) CHECK(laid.find('\n', static_cast<std::size_t>(line) * 9) <= 105);
    // Where the block has several lines they are the author's.
    checkKept({"points {\n    " + rows + "\n}\n"});
    // What stood in one block is no table but for `-` rows.
    CHECK(laidOut("a { b " + kLong + "; b 2; b " + kLong + " }") ==
          "a {\n    b " + kLong + "\n    b 2\n    b " + kLong + "\n}\n");
}

TEST_CASE("layout: comments stay where they are") {
    checkKept({"a 1     // one\nbcd 2   // two\n", "a { // c\n    b // d\n} // e\n", "// a\n/* b */ c /* d */ 1 // e\n",
               "a { b /* c */; d }\n", "/*\n * a\n */\nb\n", "// only\n", "a /* b\n  c */ 1\n"});
    checkLaidOut({{"a// c", "a // c\n"},
                  {"a; b // c", "a\nb // c\n"},
                  {"a; /* c */ b", "a\n/* c */ b\n"},
                  {"a; /* c */\nb", "a /* c */\nb\n"},
                  {"a {b // c\n}", "a {\n    b // c\n}\n"},
                  {"a {\n// c  \n}", "a {\n    // c\n}\n"},
                  {"a{// c\nb}", "a { // c\n    b\n}\n"},
                  {"/* a */b", "/* a */ b\n"},
                  {"a {\n/* b\n   c\n\n   d */\n}", "a {\n    /* b\n       c\n\n       d */\n}\n"},
                  {"a {\n        /* b\n           c\n  d */\n}", "a {\n    /* b\n       c\nd */\n}\n"}});
}

TEST_CASE("layout: continued lines go with their node") {
    checkKept({"crease 1 2 3 \\\n       4 5 6\n", "a 1 \\ // c\n    2\n", "a \\\n    k=1 { b }\n"});
    checkLaidOut({{"a {\ncrease 1 \\\n       2\n}", "a {\n    crease 1 \\\n           2\n}\n"},
                  {"    a 1 \\\n  2", "a 1 \\\n    2\n"},
                  {"a; b \\\n1", "a\nb \\\n    1\n"},
                  {"a 1 \\  \n\t\t2", "a 1 \\\n        2\n"},
                  {"a 1 \\\n\nb", "a 1\n\nb\n"},
                  {"a 1 \\ // c\n\nb", "a 1 // c\n\nb\n"},
                  {"\\\na", "a\n"},
                  {"a \\", "a\n"},
                  {"/-\n  a 1", "/-\n  a 1\n"},
                  {"a /- // c\n\n   1 2", "a /- // c\n   1 2\n"}});
}

TEST_CASE("layout: texts and numbers keep their spelling, names lose quotes that they do not need") {
    checkKept({"a 1_000 0xFf +1.50e+03 -0 #inf (u8)12\n", "a \"b\" #\"c\"# ##\"d\"# e\"##\n",
               "a \"\\u{41}\\n\" k=\"v\"\n", "a {\n    b \"\"\"\n  c\n    d\n  \"\"\" 1\n}\n", "\"a b\" \"c d\"=1\n",
               "\"true\" \"1\"=2 \"\"=3 \".5\"=4 \"a,b\"=5 \"'c\"=6\n", "(\"t\")a (\"u\")1\n"});
    checkLaidOut({{"\"a\" \"k\"=\"v\" \"w\"", "a k=\"v\" \"w\"\n"},
                  {"\"a\"{\"b\" \"c\"= 1}", "a { b c= 1 }\n"},
                  {"(\"t\")\"a\" 1", "(\"t\")a 1\n"},
                  {"/-\"a\" /-\"k\"=1", "/-a /-k=1\n"},
                  {"\"-\" 1 2", "- 1 2\n"},
                  {"a {\n  \"\"\"\n  x\n  \"\"\" 1\n}", "a {\n    \"\"\"\n  x\n  \"\"\" 1\n}\n"}});
}

TEST_CASE("layout: line ends and a byte order mark") {
    checkKept({"a\r\nb {\r\n    c\r\n}\r\n", "\xef\xbb\xbf"
                                             "a\n"});
    checkLaidOut({{"a\r\nb\nc\r", "a\r\nb\r\nc\r\n"},
                  {"a\nb\r\n", "a\nb\n"},
                  {"a\vb\u2028c\u0085", "a\nb\nc\n"},
                  {"a; b\r\n", "a\r\nb\r\n"},
                  {"a \"\"\"\r\n  x\r\n  \"\"\"\nb\n", "a \"\"\"\r\n  x\r\n  \"\"\"\nb\n"},
                  {"/* a\r\n b */\nc", "/* a\r\n b */\nc\n"},
                  {"\xef\xbb\xbf\n\n a", "\xef\xbb\xbf"
                                         "a\n"}});
}

TEST_CASE("layout: the edition") {
    const Cases cases = {{"a", "scene 1\n\na"},
                         {"", "scene 1\n\n"},
                         {"// c\na", "// c\nscene 1\n\na"},
                         {"// c\n// d\n\n// e\na", "// c\n// d\nscene 1\n\n// e\na"},
                         {"\n\n//\n\na", "\n\n//\nscene 1\n\na"},
                         {"/- kdl-version 2\n// c\na", "/- kdl-version 2\n// c\nscene 1\n\na"},
                         {"/-b\n\na", "/-b\nscene 1\n\na"},
                         {"a\r\nb\r\n", "scene 1\r\n\r\na\r\nb\r\n"},
                         {"\xef\xbb\xbf"
                          "a",
                          "\xef\xbb\xbfscene 1\n\na"},
                         {"/* c\nd */\na", "/* c\nd */\nscene 1\n\na"}};
    for (const auto& [text, expected] : cases) CHECK(withEdition(text) == expected);
}

namespace {

std::string fileText(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// What stands between ```kdl and ``` in a page.
std::vector<std::string> fences(const std::string& page) {
    std::vector<std::string> found;
    for (std::size_t at = page.find("\n```kdl"); at != std::string::npos; at = page.find("\n```kdl", at)) {
        const std::size_t begin = page.find('\n', at + 1);
        const std::size_t end = page.find("\n```", begin);
        if (end == std::string::npos) break;
        found.push_back(page.substr(begin + 1, end - begin));
        at = end + 4;
    }
    return found;
}

} // namespace

TEST_CASE("layout: every scene and snippet of the repository keeps its meaning") {
    std::vector<std::string> texts;
    for (const char* folder : {"scenes", "materials", "docs", "tests", "bench"})
        for (const auto& entry :
             std::filesystem::recursive_directory_iterator(std::filesystem::path(ABBE_SOURCE_DIR) / folder)) {
            if (entry.path().extension() == ".scene") texts.push_back(fileText(entry.path()));
            if (entry.path().extension() == ".md")
                for (std::string& text : fences(fileText(entry.path()))) texts.push_back(std::move(text));
        }
    std::size_t sound = 0;
    for (const std::string& text : texts) {
        const auto syntax = [](const auto& parsed) {
            return std::ranges::any_of(parsed.diagnostics.all(),
                                       [](const auto& d) { return d.code.starts_with("E01"); });
        };
        const auto before = parseText(text);
        if (syntax(before)) continue; // those that show mistakes
        ++sound;
        const std::string once = layOut(text);
        const auto after = parseText(once);
        CHECK_MESSAGE(!syntax(after), text);
        CHECK_MESSAGE(sameMeaning(*before.document, *after.document), text);
        CHECK_MESSAGE(layOut(once) == once, text);
    }
    CHECK(sound > 250);
}

TEST_CASE("layout: time grows with the text, however it nests") {
    std::string nested, comments = "a; ", names;
    for (int i = 0; i < 250; ++i) nested += "a{";
    for (int i = 0; i < 20000; ++i) nested += "b;";
    nested += std::string(250, '}');
    for (int i = 0; i < 50000; ++i) comments += "/**/";
    for (int i = 0; i < 50000; ++i) names += "a{b}/-{c};- 1;- 2;";
    for (const std::string& text : {nested, comments, names}) CHECK(layOut(text).size() >= text.size() / 2);
}

TEST_CASE("trees are compared by all that they say") {
    const auto same = [](const char* a, const char* b) {
        return sameMeaning(*parseText(a).document, *parseText(b).document);
    };
    CHECK(same("a 1 { b }", "a  1 {\nb\n}\n"));
    for (const auto& [a, b] : std::vector<std::pair<const char*, const char*>>{{"a 1", "a 2"},
                                                                               {"a 1", "a 1.0 k=1"},
                                                                               {"a", "b"},
                                                                               {"a \"b\"", "a b"},
                                                                               {"a { }", "a"},
                                                                               {"a { b }", "a { c }"},
                                                                               {"a;b", "a { b }"},
                                                                               {"a k=1", "a l=1"},
                                                                               {"a k=1", "a k=2"},
                                                                               {"a #true", "a #false"},
                                                                               {"a b 1", "a b 2"},
                                                                               {"param x 1", "param x 2"},
                                                                               {"param x 1", "param y 1"},
                                                                               {"param x 1 \"c\"", "param x 1 \"d\""},
                                                                               {"a 0", "a -0"}})
        CHECK_MESSAGE(!same(a, b), a << " and " << b);
}

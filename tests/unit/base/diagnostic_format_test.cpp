// The three forms of diagnostics, and applying their repairs.
#include "base/diagnostic.h"
#include "base/diagnostic_format.h"

#include <doctest/doctest.h>
#include <string>

using namespace abbe;

namespace {

// A text with diagnostics at places that are found by their words.
struct Fixture {
    SourceMap sources;
    FileId file;
    Diagnostics diagnostics;

    explicit Fixture(std::string text, std::string path = "broken.scene")
        : file(sources.add(std::move(path), std::move(text))) {}
    Span at(std::string_view word, std::size_t from = 0) const {
        const std::size_t begin = sources.text(file).find(word, from);
        return {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(begin + word.size())};
    }
    std::string human(FormatOptions options = {}) const { return formatHuman(diagnostics, sources, options); }
};

} // namespace

TEST_CASE("the style of the language's manual, to the letter") {
    Fixture f("scene 1 length=cm\n\ncamera {\n    from 0 165 320\n    lense 85mm\n    f-stop 2.8 cm\n}\n"
              "material skin subsurface { roughness 1.38 }\n"
              "light rim quad { size 60 120; power 2400 lm; luminance 5000 nits }\n"
              "shape hero subdivision \"hero/bdoy.obj\" { material sking }\n"
              "material skin diffuse { reflectance rgb 1.2 0.8 0.7 }\n");
    Diagnostics& d = f.diagnostics;
    Diagnostic& twice = d.error("E0203", f.at("skin", f.at("diffuse").begin - 5), "material `skin` is defined twice",
                                "second definition");
    twice.related.push_back({f.at("skin"), "the first definition is here"});
    twice.help = "to change it in a layer, write `override material skin { ... }`";
    Diagnostic& amount =
        d.error("E0310", f.at("luminance 5000 nits"), "`light rim` states its amount twice", "second amount");
    amount.related.push_back({f.at("power 2400 lm"), "first amount"});
    amount.notes.push_back("over 60 x 120 cm, 2400 lm is 1061 nits; keep one of the two");
    Diagnostic& unknown = d.error("E0201", f.at("lense"), "`camera` has no property `lense`", "unknown property");
    unknown.help = "did you mean `lens` (focal length, e.g. `50 mm`)?";
    unknown.fixes.push_back({f.at("lense"), "lens"});
    d.error("E0105", f.at("85mm"), "a number and its unit are two words", "write `85 mm`")
        .fixes.push_back({f.at("85mm"), "85 mm"});
    d.warning("W0201", f.at("hero"), "shape `hero` is odd");

    CHECK(f.human() == R"(error[E0201]: `camera` has no property `lense`
  --> broken.scene:5:5
   |
 5 |     lense 85mm
   |     ^^^^^ unknown property
   = help: did you mean `lens` (focal length, e.g. `50 mm`)?

error[E0105]: a number and its unit are two words
  --> broken.scene:5:11
   |
 5 |     lense 85mm
   |           ^^^^ write `85 mm`

error[E0310]: `light rim` states its amount twice
  --> broken.scene:9:46
   |
 9 | light rim quad { size 60 120; power 2400 lm; luminance 5000 nits }
   |                               -------------  ^^^^^^^^^^^^^^^^^^^ second amount
   |                               first amount
   = note: over 60 x 120 cm, 2400 lm is 1061 nits; keep one of the two

warning[W0201]: shape `hero` is odd
  --> broken.scene:10:7
   |
10 | shape hero subdivision "hero/bdoy.obj" { material sking }
   |       ^^^^

error[E0203]: material `skin` is defined twice
  --> broken.scene:11:10
   |
11 | material skin diffuse { reflectance rgb 1.2 0.8 0.7 }
   |          ^^^^ second definition
note: the first definition is here
  --> broken.scene:8:10
   = help: to change it in a layer, write `override material skin { ... }`

broken.scene: 4 errors, 1 warning. `abbe check --fix` repairs 2 of them; `abbe explain E0310` says more.
)");
    CHECK(formatShort(d, f.sources) ==
          "broken.scene:5:5: error[E0201]: `camera` has no property `lense` (unknown property)\n"
          "broken.scene:5:11: error[E0105]: a number and its unit are two words (write `85 mm`)\n"
          "broken.scene:9:46: error[E0310]: `light rim` states its amount twice (second amount)\n"
          "broken.scene:10:7: warning[W0201]: shape `hero` is odd\n"
          "broken.scene:11:10: error[E0203]: material `skin` is defined twice (second definition)\n");
}

TEST_CASE("several parts of one line") {
    Fixture f("first second third\n");
    Diagnostic& d = f.diagnostics.error("E0001", f.at("first"), "m", "primary");
    d.related.push_back({f.at("third"), "c"});
    d.related.push_back({f.at("second"), "b"});
    CHECK(f.human().find(" 1 | first second third\n"
                         "   | ^^^^^ ------ ----- c\n"
                         "   |       b\n"
                         "   | primary\n") != std::string::npos);
}

TEST_CASE("tabs, wide characters, empty spans and spans over line ends") {
    Fixture f("\ta\t\u00e9\u00e9 mark\nx \x01y\nend");
    f.diagnostics.error("E0001", f.at("mark"), "m");
    f.diagnostics.error("E0002", {f.file, f.at("\x01").begin, f.at("end").end}, "m");
    f.diagnostics.error("E0003", {f.file, f.at("end").end, f.at("end").end}, "m", "here");
    const std::string text = f.human();
    CHECK(text.find(" 1 |     a   \u00e9\u00e9 mark\n   |            ^^^^\n") != std::string::npos);
    CHECK(text.find(" 2 | x \ufffdy\n   |   ^^\n") != std::string::npos);
    CHECK(text.find("  --> broken.scene:3:4\n   |\n 3 | end\n   |    ^ here\n") != std::string::npos);
}

TEST_CASE("very long lines are cut around the carets") {
    Fixture f(std::string(5000, 'a') + "\u00e9 mark " + std::string(5000, 'b'));
    f.diagnostics.error("E0001", f.at("mark"), "m").related.push_back({{f.file, 3, 5}, "far away"});
    const std::string text = f.human();
    CHECK(text.find(" 1 | \u2026" + std::string(38, 'a') + "\u00e9 mark " + std::string(55, 'b') + "\u2026\n   | " +
                    std::string(41, ' ') + "^^^^\n") != std::string::npos);
    CHECK(text.find("note: far away\n  --> broken.scene:1:4\n") != std::string::npos);
    CHECK(text.size() < 500);
}

TEST_CASE("at most so many errors are shown, then a count") {
    Fixture f("a b");
    for (int i = 0; i < 30; ++i) f.diagnostics.error("E0001", f.at("a"), "m");
    for (int i = 0; i < 3; ++i) f.diagnostics.warning("W0001", f.at("b"), "w");
    const std::string text = f.human();
    std::size_t shown = 0;
    for (std::size_t i = text.find("error["); i != std::string::npos; i = text.find("error[", i + 1)) ++shown;
    CHECK(shown == 20);
    CHECK(text.find("\u2026 and 10 more\n\nbroken.scene: 30 errors, 3 warnings. ") != std::string::npos);
    CHECK(f.human({false, 2, "my name"}).find("my name: 30 errors") != std::string::npos);
}

TEST_CASE("no place, no text, nothing at all") {
    Fixture f("");
    CHECK(f.human().empty());
    CHECK(formatJson(f.diagnostics, f.sources) == "[]\n");
    f.diagnostics.error("E0410", {f.file, 0, 0}, "file not found: `broken.scene`");
    f.diagnostics.error("E0601", {}, "the scene has no camera").help = "add one";
    CHECK(f.human() == "error[E0601]: the scene has no camera\n   = help: add one\n\n"
                       "error[E0410]: file not found: `broken.scene`\n\n"
                       "2 errors, 0 warnings. `abbe explain E0601` says more.\n");
}

TEST_CASE("colour is only escape sequences") {
    Fixture f("a b");
    f.diagnostics.error("E0001", f.at("b"), "m", "l").help = "h";
    std::string plain = f.human({true, 20, {}});
    CHECK(plain.find("\x1b[1;31merror[E0001]\x1b[0m") == 0);
    for (std::size_t i = plain.find('\x1b'); i != std::string::npos; i = plain.find('\x1b'))
        plain.erase(i, plain.find('m', i) - i + 1);
    CHECK(plain == f.human());
}

TEST_CASE("JSON with the fields of LSP") {
    Fixture f("x \U0001F600 \"q\"\ny\n");
    Diagnostic& d = f.diagnostics.error("E0001", f.at("\"q\""), "say \"hi\" \\ \x01", "l\n");
    d.related.push_back({f.at("y"), "other"});
    d.notes.push_back("n");
    d.help = "h";
    d.fixes.push_back({f.at("y"), "z"});
    CHECK(formatJson(f.diagnostics, f.sources) ==
          "[\n{\"path\":\"broken.scene\",\"range\":{\"start\":{\"line\":0,\"character\":5},\"end\":{\"line\":0,"
          "\"character\":8}},"
          "\"severity\":1,\"code\":\"E0001\",\"source\":\"abbe\",\"message\":\"say \\\"hi\\\" \\\\ \\u0001 (l\\n)\","
          "\"relatedInformation\":[{\"location\":{\"uri\":\"broken.scene\",\"range\":{\"start\":{\"line\":1,"
          "\"character\":0},"
          "\"end\":{\"line\":1,\"character\":1}}},\"message\":\"other\"}],"
          "\"data\":{\"label\":\"l\\n\",\"notes\":[\"n\"],\"help\":\"h\",\"fixes\":[{\"range\":{\"start\":{\"line\":1,"
          "\"character\":0},"
          "\"end\":{\"line\":1,\"character\":1}},\"newText\":\"z\"}]}}\n]\n");
}

TEST_CASE("fixes: all of a diagnostic or none, the first of two that overlap") {
    Fixture f("abc def ghi");
    Diagnostics& d = f.diagnostics;
    Diagnostic& both = d.error("E1", f.at("abc"), "m");
    both.fixes = {{f.at("abc"), "A"}, {f.at("ghi"), "GGGG"}};
    Diagnostic& blocked = d.error("E2", f.at("def"), "m");
    blocked.fixes = {{f.at("def"), "D"}, {f.at("hi"), "x"}};
    d.error("E3", f.at(" def"), "m").fixes = {{{f.file, 3, 3}, ","}};
    d.error("E4", f.at(" def"), "m").fixes = {{{f.file, 3, 3}, ";"}};
    d.error("E5", f.at("abc"), "m").fixes = {{{FileId{7}, 0, 1}, "other file"}};
    const FixResult result = applyFixes(f.sources.text(f.file), f.file, d);
    CHECK(result.text == "A, def GGGG");
    CHECK(result.applied == 2);
}

TEST_CASE("of one code a thousand are listed, the others counted") {
    Fixture f("a b");
    for (int i = 0; i < 3000; ++i) f.diagnostics.error("E0202", f.at("b"), "no such name").help = "help";
    for (int i = 0; i < 10; ++i) f.diagnostics.warning("W0201", f.at("a"), "unused");
    CHECK(f.diagnostics.errorCount() == 3000);
    CHECK(f.diagnostics.warningCount() == 11);
    CHECK(f.diagnostics.all().size() == 1011);
    CHECK(f.diagnostics.all()[1000].code == "W0199");
    CHECK(f.human().find("… and 2980 more") != std::string::npos);
    CHECK(f.human().find("3000 errors, 11 warnings") != std::string::npos);

    Diagnostics both;
    both.addAll(f.diagnostics);
    CHECK(both.errorCount() == 3000);
    CHECK(both.warningCount() == 11);
    CHECK(both.all().size() == 1011);
}

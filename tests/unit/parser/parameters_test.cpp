// `param`, `$name` and `-D name=value`.
#include "parse_text.h"

#include <doctest/doctest.h>

using namespace abbe;
using abbe::test::parseText;

TEST_CASE("a parameter's values, with their unit, stand where its name is used") {
    const auto parsed =
        parseText("a { rotate z $turn 1 }\nparam turn -32.9 deg \"how far\"\nb $turn $turn k=$n\nparam n 3\n");
    REQUIRE(parsed.diagnostics.all().empty());
    CHECK(parsed.printed() == "a {\n    rotate z -32.9 deg 1\n}\nb -32.9 deg -32.9 deg k=3\n");
    const schema::Value value = (*parsed.root().children().begin()).value(1);
    CHECK(parsed.sources->text(value.span) == "-32.9");
    CHECK(parsed.sources->text(value.use) == "$turn");
    CHECK(value.number == -32.9);
    REQUIRE(parsed.document->parameters.size() == 2);
    CHECK(parsed.document->parameters[0].name == "turn");
    CHECK(parsed.document->parameters[0].doc == "how far");
    CHECK(parsed.document->parameters[0].defaultText == "-32.9 deg");
}

TEST_CASE("texts as parameters") {
    const auto parsed = parseText("param file \"a b.ply\" \"the mesh\"\nmesh $file\nm \"$file\"\n");
    CHECK(parsed.diagnostics.all().empty());
    CHECK(parsed.printed() == "mesh \"a b.ply\"\nm \"$file\"\n");
}

TEST_CASE("values from the command line") {
    const std::string text = "param yaw 25 deg\nparam file \"a.ply\"\nparam mode fast\na $yaw $file $mode\n";
    const auto parsed = parseText(text, {"yaw=-1.5e1 rad", "file=dir/b c.ply", "mode=slow"});
    CHECK(parsed.codes().empty());
    CHECK(parsed.printed() == "a -15 rad \"dir/b c.ply\" slow\n");
    const schema::Value value = parsed.root().value(0);
    CHECK(parsed.sources->path(value.span.file) == "-D yaw");
    CHECK(parsed.sources->text(value.span) == "-1.5e1");
    CHECK(parseText(text, {"file=\"c.ply\""}).printed() == "a 25 deg \"c.ply\" fast\n");
    CHECK(parseText(text, {"yaw=1", "yaw=2"}).printed() == "a 2 \"a.ply\" fast\n");
    CHECK(parseText(text, {"yaw=2 deg"}).document->parameters[0].defaultText == "25 deg");
}

TEST_CASE("mistakes on the command line are located in it") {
    const std::string text = "param yaw 25 deg\na $yaw\n";
    const auto typo = parseText(text, {"yaw=25deg"});
    CHECK(typo.errors() == "-D yaw:1:1: error[E0105]: a number and its unit are two words (write `25 deg`)\n");
    CHECK(typo.printed() == "a 25 deg\n");
    const auto unknown = parseText(text, {"yav=3"});
    CHECK(unknown.errors() ==
          "-D yav:1:1: error[E0221]: the scene has no parameter `yav` (did you mean `-D yaw=3`?)\n");
    CHECK(parseText(text, {"yaw"}).errors() ==
          "-D:1:1: error[E0222]: a parameter is given as `-D name=value` (no `=`)\n");
    CHECK(parseText(text, {"yaw="}).errors().find("E0222") != std::string::npos);
    CHECK(parseText(text, {"yaw=$yaw"}).errors().find("E0223") != std::string::npos);
    CHECK(parseText(text, {"yaw={ }"}).errors().find("E0101") != std::string::npos);
    CHECK(parseText(text, {"yaw=\"a"}).errors().find("E0103") != std::string::npos);
}

TEST_CASE("mistakes in parameters") {
    CHECK(parseText("a $x").codes() == "E0204@2-4");
    CHECK(parseText("a k=$x").codes() == "E0204@4-6");
    CHECK(parseText("param x 1\nparam x 2\na $x").codes() == "E0220@16-17");
    CHECK(parseText("param x").codes() == "E0222@6-7");
    CHECK(parseText("param").codes() == "E0222@0-5");
    CHECK(parseText("param 1 2").codes() == "E0222@6-7");
    CHECK(parseText("param x 1 { a }\nb $x").codes() == "E0222@0-9");
    CHECK(parseText("param x 1 k=2\nb $x").codes() == "E0222@0-13");
    CHECK(parseText("param x 1\nparam y $x\nb $y").codes() == "E0223@18-20 W0205@6-7");
    CHECK(parseText("param x 1 mm\nb k=$x").codes() == "E0224@17-19");
    CHECK(parseText("param x 1\nb").codes() == "W0205@6-7");
    CHECK(parseText("param x 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\nb $x").codes() == "E0222@46-48");
}

TEST_CASE("parameters and slashdashes, keys that are given twice, words in blocks") {
    CHECK(parseText("/-param x 1\na $x").codes() == "E0204@14-16");
    CHECK(parseText("param x 1\n/-a $x").codes() == "W0205@6-7");
    CHECK(parseText("param x 1\na /-$x 2").codes() == "W0205@6-7");
    const auto twice = parseText("param x 1\nparam y 2\na k=$x l=$y k=$y $x");
    CHECK(twice.printed() == "a 1 l=2 k=2\n");
    CHECK(parseText("param x 1\na $x=5").codes() == "W0205@6-7");
    CHECK(parseText("a { param x 1 }").codes().empty()); // no parameter: an unknown property for the schema
}

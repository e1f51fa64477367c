// Scenes as JSON, and the spelling of units by which `abbe fmt` writes them.
#include "language_fixture.h"
#include "schema/describe.h"
#include "schema/json_schema.h"

#include <doctest/doctest.h>

using namespace language_test;

namespace {

struct ReadText {
    SourceMap sources;
    Diagnostics diagnostics;
    std::string text;
    std::shared_ptr<schema::Document> document;

    explicit ReadText(std::string given) : text(given) {
        document = parse(sources, sources.add("test.scene", std::move(given)), {}, diagnostics);
    }
};

std::string tree(const std::string& text) {
    std::string json = treeJson(*ReadText(text).document);
    std::erase(json, '\n');
    return json;
}

std::string spelled(const std::string& text) {
    const ReadText read(text);
    return withCanonicalUnits(read.text, *read.document);
}

} // namespace

TEST_CASE("a tree of JSON has what the nodes have") {
    CHECK(tree("") == "[]");
    CHECK(tree("scene 1") == R"([{"name":"scene","values":[1]}])");
    CHECK(
        tree("camera { lens 50 mm; from 0 -1.5 4e3 }") ==
        R"([{"name":"camera","children":[{"name":"lens","values":[50,"mm"]},{"name":"from","values":[0,-1.5,4000]}]}])");
    CHECK(
        tree("film { output \"a\\\"b.exr\" space=acescg depth=16 }") ==
        R"([{"name":"film","children":[{"name":"output","values":["a\"b.exr"],"keys":{"space":"acescg","depth":16}}]}])");
    CHECK(tree("a #true #false #null #inf #-inf #nan") ==
          R"([{"name":"a","values":[true,false,null,"#inf","#-inf","#nan"]}])");
    CHECK(tree("a {}") == R"([{"name":"a","children":[]}])");
    CHECK(tree("p { - 0 1 2; - 3 4 5 }") ==
          R"([{"name":"p","children":[{"name":"-","values":[0,1,2]},{"name":"-","values":[3,4,5]}]}])");
    CHECK(tree("a \"\\u{1}\"") == R"([{"name":"a","values":["\u0001"]}])");
    CHECK(tree("/- a 1\nb /- 2 3") == R"([{"name":"b","values":[3]}])");
}

TEST_CASE("parameters come first, and stand where they were asked for") {
    CHECK(tree("shape sphere { radius $r }\nparam r 2 cm \"how large\"") ==
          R"([{"name":"param","values":["r",2,"cm","how large"]},)"
          R"({"name":"shape","values":["sphere"],"children":[{"name":"radius","values":[2,"cm"]}]}])");
}

TEST_CASE("units have one spelling, and nothing else changes") {
    CHECK(schema::canonicalUnit("cd-per-m2") == "nits");
    CHECK(schema::canonicalUnit("EV") == "stops");
    CHECK(schema::canonicalUnit("µm") == "um");
    CHECK(schema::canonicalUnit("mm") == "mm");
    CHECK(schema::canonicalUnit("parsec") == "");
    CHECK(spelled("light sky { luminance 1e3 cd-per-m2 } // cd-per-m2") ==
          "light sky { luminance 1e3 nits } // cd-per-m2");
    CHECK(spelled("camera { exposure 1.50 EV; lens 0.50e2 mm }") == "camera { exposure 1.50 stops; lens 0.50e2 mm }");
    CHECK(spelled("a { thickness 5 µm; t \"$d * 2\" µm }") == "a { thickness 5 um; t \"$d * 2\" um }");
    CHECK(spelled("param d 5 µm\na $d") == "param d 5 um\na $d");
    CHECK(spelled("a \"5 µm\"; b EV 1; c 1 \"EV\"") == "a \"5 µm\"; b EV 1; c 1 \"EV\"");
    // A name that some definition has may be meant.
    CHECK(spelled("spectrum EV rgb 1 1 1\nramp { stop 0.5 EV }") == "spectrum EV rgb 1 1 1\nramp { stop 0.5 EV }");
}

#include "schema/binding.h"
#include "schema/expression.h"
#include "schema/measure.h"
#include "schema/scene_tree.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::schema;

TEST_CASE("default texts become values") {
    const auto document = documentOf("sensor", "36 24.5  mm \"a\" on -1e-3 inf");
    const Node node = *document->roots().begin();
    CHECK(node.name() == "sensor");
    REQUIRE(node.valueCount() == 7);
    CHECK(node.value(0).number == 36);
    CHECK(node.value(1).number == 24.5);
    CHECK(node.value(2).kind == ValueKind::word);
    CHECK(node.value(3).kind == ValueKind::string);
    CHECK(node.value(3).text == "a");
    CHECK(node.value(4).text == "on");
    CHECK(node.value(5).number == -1e-3);
    CHECK(node.value(6).kind == ValueKind::word); // no number of ours
    CHECK(!node.hasBlock());
    CHECK((*documentOf("a", "")->roots().begin()).valueCount() == 0);
}

TEST_CASE("texts that are meant to be computed") {
    const auto computed = [](std::string_view text) {
        Value value;
        value.kind = ValueKind::string;
        value.text = text;
        return isComputed(value);
    };
    for (const char* text :
         {"1/48", "1/48 s", "12", " 2 cm", "-2", "- (2)", "$r", "(1 + 2)", "sin(30 deg)", "pi", "pi / 2", "min (1, 2)"})
        CHECK(computed(text));
    for (const char* text :
         {"", " ", "hero/body.obj", "wood.png", "m", "pigment", "pi.exr", "sine", "sin", "#ff0000", "-", "=2"})
        CHECK(!computed(text));
    Value word;
    word.kind = ValueKind::word;
    word.text = "pi";
    CHECK(!isComputed(word)); // a name
}

TEST_CASE("ranges read well") {
    constexpr double inf = std::numeric_limits<double>::infinity();
    CHECK(rangeText(0, 1, 1, "") == "must be between 0 and 1");
    CHECK(rangeText(0, inf, 1, "W") == "must be at least 0 W");
    CHECK(rangeText(-inf, 0.5, 0.01, "%") == "must be at most 50%");
    CHECK(rangeText(std::numeric_limits<double>::min(), inf, 1, "m") == "must be above 0");
    CHECK(rangeText(std::numeric_limits<double>::min(), 2, 1, "m") == "must be above 0 and at most 2 m");
    CHECK(rangeText(100, 1e6, 1, "K") == "must be between 100 and 1000000 K");
}

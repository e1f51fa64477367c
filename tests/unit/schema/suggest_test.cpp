#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <doctest/doctest.h>
#include <string>

using namespace abbe::schema;

TEST_CASE("edit distances") {
    CHECK(editDistance("", "") == 0);
    CHECK(editDistance("abc", "abc") == 0);
    CHECK(editDistance("abc", "ABC") == 0);
    CHECK(editDistance("lense", "lens") == 1);
    CHECK(editDistance("bdoy", "body") == 1); // two neighbours swapped
    CHECK(editDistance("kitten", "sitting") == 3);
    CHECK(editDistance("", "abc") == 3);
    CHECK(editDistance("ca", "abc") == 3); // optimal string alignment; the unrestricted distance is 2
}

TEST_CASE("suggestions stay within a third of the word") {
    CHECK(nearest("lense", {"lens", "sensor"}) == "lens");
    CHECK(nearest("sesnor", {"lens", "sensor"}) == "sensor");
    CHECK(nearest("abcdef", {"abxyef"}) == "abxyef"); // two of six
    CHECK(nearest("abcdef", {"axyzef"}).empty());     // three of six
    CHECK(nearest("Kd", {"kd"}) == "kd");
    CHECK(nearest("r", {"x"}).empty());
    CHECK(nearest("ab", {"xy"}).empty());
    CHECK(nearest("", {"a"}).empty());
    CHECK(nearest("skin", {}).empty());
    CHECK(nearest(std::string(100000, 'a'), {"a"}).empty());
    CHECK(nearest("fob", {"foo", "fob"}) == "fob"); // the nearest, not the first
}

TEST_CASE("synonyms of fields") {
    TypeInfo type{Kind::camera, "perspective", "", "", true, {}};
    FieldInfo fov, lens;
    fov.name = "fov";
    fov.synonyms = {"fovy", "angle-of-view"};
    lens.name = "lens";
    type.fields = {lens, fov};
    CHECK(suggestField(type, "fovy")->name == "fov");
    CHECK(suggestField(type, "FOVY")->name == "fov");
    CHECK(suggestField(type, "lense")->name == "lens");
    CHECK(suggestField(type, "angle-of-veiw")->name == "fov");
    CHECK(suggestField(type, "shutter") == nullptr);
}

TEST_CASE("lists for messages") {
    const std::string_view words[] = {"a", "b", "c"};
    CHECK(quotedList(words) == "`a`, `b` and `c`");
    CHECK(quotedList(std::span(words, 2), "or") == "`a` or `b`");
    CHECK(quotedList(std::span(words, 1)) == "`a`");
    CHECK(quotedList({}).empty());
    const std::vector<std::string_view> many(100, "x");
    CHECK(quotedList(many).ends_with(", …"));
}

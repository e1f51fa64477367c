// What people of other programs ask `abbe explain` for, and measured data by name.
#include "parser/presets.h"
#include "scene/registry.h"
#include "schema/describe.h"
#include "schema/foreign_words.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <string>

using namespace abbe;

namespace {

struct Explained {
    Explained() { addPresets(types, sources, diagnostics); }
    std::string operator()(std::string_view query) const {
        const schema::Explanation answer = schema::explain(types, query);
        return answer.found ? answer.text : std::string();
    }
    bool says(std::string_view query, std::string_view text) const {
        return (*this)(query).find(text) != std::string::npos;
    }

    SourceMap sources;
    Diagnostics diagnostics;
    schema::TypeTable types = makeTypeTable();
};

} // namespace

TEST_CASE("explain: every word of other programs leads to something, and to no other word of ours") {
    const Explained explain;
    const auto terms = schema::foreignTerms();
    CHECK(terms.size() > 100);
    CHECK(std::ranges::is_sorted(terms, {}, &schema::ForeignTerm::term));
    for (const schema::ForeignTerm& term : terms) {
        INFO(std::string(term.term));
        CHECK(schema::findForeignTerm(term.term) == &term); // not hidden by another one
        CHECK(term.here.ends_with('.'));
        CHECK(explain(term.term) != "");
        const std::string more = explain(term.topic);
        CHECK(more != "");
        CHECK(more.find("a word of") == std::string::npos); // the topic is ours
    }
}

TEST_CASE("explain: words of other programs, however they are written") {
    const Explained explain;
    for (const char* area : {"area light", "Area Light", "AreaLight", "area_light", "area-light", "area lights"})
        CHECK_MESSAGE(explain.says(area, "light quad"), area);
    CHECK(explain.says("principled", "openpbr"));
    CHECK(explain.says("Principled BSDF", "openpbr"));
    CHECK(explain.says("roughplastic", "openpbr"));
    CHECK(explain.says("Sky texture", "light daylight"));
    CHECK(explain.says("standard_surface", "openpbr"));
    CHECK(explain.says("trianglemesh", "shape mesh"));
    CHECK(explain("frobnicator") == "");
    // Our own words are ours.
    CHECK(!explain.says("sheen", "a word of"));
    CHECK(!explain.says("light", "a word of"));
}

TEST_CASE("explain: glasses, metals, lights and reflectances by name") {
    const Explained explain;
    CHECK(explain.says("BK7", "glass N-BK7"));
    CHECK(explain.says("n-bk7", "1.5168 at 587.6 nm, Abbe number 64.2"));
    CHECK(explain.says("glass SF11", "glass SF11"));
    CHECK(explain.says("Au", "metal Au"));
    CHECK(explain.says("D65", "illuminant D65"));
    CHECK(explain.says("macbeth-13", "measured macbeth-13"));
    CHECK(!explain.says("metal BK7", "glass"));
}

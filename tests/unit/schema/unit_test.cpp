#include "math/vec.h"
#include "schema/suggest.h"
#include "schema/unit.h"

#include <doctest/doctest.h>
#include <string>

using namespace abbe;
using namespace abbe::schema;

TEST_CASE("units have their defined sizes") {
    const auto scale = [](const char* name) { return findUnit(name).value().scale; };
    CHECK(scale("mm") == 0.001);
    CHECK(scale("nm") == 1e-9);
    CHECK(scale("in") == 0.0254);
    CHECK(scale("ft") == doctest::Approx(12 * 0.0254).epsilon(1e-15));
    CHECK(scale("turn") == 2 * kPiD);
    CHECK(scale("deg") * 180 == doctest::Approx(kPiD).epsilon(1e-15));
    CHECK(scale("h") == 3600);
    CHECK(scale("%") == 0.01);
    CHECK(scale("klx") == 1000);
    CHECK(scale("per-mm") == 1000);
    CHECK(scale("EV") == 1);
    CHECK(!findUnit("MM"));
    CHECK(!findUnit("m "));
    CHECK(!findUnit(""));
}

TEST_CASE("every spelling is a unit of its dimension, and the SI unit has size 1") {
    for (int i = 0; i <= static_cast<int>(Dimension::pixels); ++i) {
        const auto d = static_cast<Dimension>(i);
        CHECK(!describe(d).empty());
        for (const std::string_view name : spellings(d)) {
            REQUIRE(findUnit(name));
            CHECK(findUnit(name)->dimension == d);
        }
        if (siUnit(d).empty()) continue;
        CHECK(findUnit(siUnit(d)).value().dimension == d);
        CHECK(findUnit(siUnit(d)).value().scale == 1);
    }
}

TEST_CASE("units by other names") {
    const Dimension length[] = {Dimension::length};
    CHECK(suggestUnit("meters", length) == "m");
    CHECK(suggestUnit("MM", length) == "mm");
    CHECK(suggestUnit("Degrees", length) == "deg");
    CHECK(suggestUnit("xyz", length).empty());
}

#include "app/render_warnings.h"

#include <doctest/doctest.h>

using namespace abbe;

TEST_CASE("densities above their bounds: a few are no news, many are a warning") {
    for (const std::uint64_t above : {0, 9, 10, 500}) {
        Diagnostics diagnostics;
        warnOfDensities({1000, above, 2.5f}, diagnostics);
        REQUIRE(diagnostics.all().size() == (above >= 10 ? 1 : 0));
        if (above < 10) continue;
        CHECK(diagnostics.all()[0].code == "W0643");
        CHECK(diagnostics.all()[0].message.find("2.5 times") != std::string::npos);
    }
    Diagnostics diagnostics;
    warnOfDensities({}, diagnostics);
    CHECK(diagnostics.all().empty());
}

#include "reports/render_warnings.h"

#include <doctest/doctest.h>

using namespace abbe;

TEST_CASE("pixels without a sample: the time is blamed only where it ended early") {
    const auto said = [](bool allBegun, std::uint64_t dropped) {
        Diagnostics diagnostics;
        warnOfMissingSamples({25, {0, 0, 10, 10}, allBegun, dropped}, diagnostics);
        REQUIRE(diagnostics.all().size() == 1);
        CHECK(diagnostics.all()[0].code == "W0668");
        CHECK(diagnostics.all()[0].message.find("25 % of the image") != std::string::npos);
        return diagnostics.all()[0].message + diagnostics.all()[0].help;
    };
    CHECK(said(false, 0).find("the time ended before") == 0);
    CHECK(said(false, 0).find("dropped") == std::string::npos);
    CHECK(said(false, 3).find("the time ended before every pixel had a sample, and samples were dropped") == 0);
    CHECK(said(true, 3).find("all samples of some pixels were dropped") == 0);
    CHECK(said(true, 3).find("time") == std::string::npos);
    Diagnostics diagnostics;
    warnOfMissingSamples({0, {0, 0, 10, 10}, true, 3}, diagnostics);
    CHECK(diagnostics.all().empty());
}

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

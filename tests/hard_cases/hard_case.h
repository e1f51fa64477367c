// What a test of a hard case says: what it measured, the tolerance that docs/hard_cases.md states, and what the obvious
// formula gives in the same place. The lines go to a file, from which page.cpp makes that page.
#pragma once

#include "doctor/numeric_check.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace abbe::test {

// Of the running test, which is called "case 28: …". One for each test; several tests may be of one case.
class HardCase {
  public:
    HardCase() : number_(std::atoi(doctest::getContextOptions()->currentTest->m_name + sizeof "case")) {
        REQUIRE(number_ >= 1);
        REQUIRE(number_ <= 80);
    }
    ~HardCase() {
        CHECK(lines_ > 0); // a test that measures nothing is none
    }
    HardCase(const HardCase&) = delete;
    HardCase& operator=(const HardCase&) = delete;

    // Must be at most the tolerance; not a number is a failure.
    void measured(std::string_view what, double value, double tolerance) {
        INFO("case ", number_, ", ", std::string(what));
        CHECK(value <= tolerance);
        tell("most", what, value, tolerance);
    }
    // Must be at least this: probabilities of a test.
    void atLeast(std::string_view what, double value, double least) {
        INFO("case ", number_, ", ", std::string(what));
        CHECK(value >= least);
        tell("least", what, value, least);
    }
    // What the obvious formula gives in place of the last measurement. It has to miss the tolerance.
    void naive(std::string_view how, double value) {
        INFO("case ", number_, ", naive: ", std::string(how));
        CHECK_FALSE((least_ ? value >= tolerance_ : value <= tolerance_));
        tell("naive", how, value, tolerance_);
    }
    // The checks of `abbe doctor --numerics` of this case.
    void doctor() {
        for (const doctor::NumericCheck& c : doctor::numericChecks())
            if (c.hardCase == number_) measured(c.measured, c.measure(), c.tolerance);
    }

  private:
    void tell(const char* kind, std::string_view text, double value, double tolerance) {
        ++lines_;
        if (std::string_view(kind) != "naive") {
            tolerance_ = tolerance;
            least_ = std::string_view(kind) == "least";
        }
        const char* const path = std::getenv("ABBE_HARD_CASES"); // a file
        if (!path) return;
        static std::FILE* const file = std::fopen(path, "w");
        REQUIRE(file);
        // Numbers as text: JSON has no infinity.
        const nlohmann::json line = {{"case", number_},
                                     {"kind", kind},
                                     {"text", text},
                                     {"value", fmt::format("{}", value)},
                                     {"tolerance", fmt::format("{}", tolerance)}};
        std::fprintf(file, "%s\n", line.dump().c_str());
        std::fflush(file);
    }

    int number_, lines_ = 0;
    double tolerance_ = 0;
    bool least_ = false;
};

} // namespace abbe::test

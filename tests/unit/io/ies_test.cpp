#include "io/file.h"
#include "io/ies.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe {
namespace {

// A light with three vertical angles and the given planes; intensities 1, 2, 3, …
std::string iesText(const std::string& first, const std::string& planes, int count,
                    const std::string& factors = "1 1 10", const std::string& multiplier = "2") {
    std::string text = first + "[MANUFAC] none\nTILT=NONE\n1 1000 " + multiplier + " 3 " + std::to_string(count) +
                       " 1 2 0 0 0\n" + factors + "\n0 45 90\n" + planes + "\n";
    for (int i = 0; i < 3 * count; ++i) text += std::to_string(i + 1) + (i % 3 == 2 ? "\n" : " ");
    return text;
}

std::string failure(const std::string& text) {
    try {
        parseIes(text, "a.ies");
    } catch (const IoError& e) {
        return e.what();
    }
    return "";
}

} // namespace

TEST_CASE("IES files of every edition") {
    for (const char* first : {"a lamp of 1986\nmore about it\n", "IESNA91\n", "IESNA:LM-63-1995\n",
                              "IESNA:LM-63-2002\n", "IES:LM-63-2019\r\n"}) {
        const IntensityTable t = parseIes(iesText(first, "0", 1), "a.ies");
        CHECK(t.vertical.size() == 3);
        CHECK(t.vertical[1] == doctest::Approx(45 * kDegree));
        CHECK(t.symmetry == PlaneSymmetry::axial);
        CHECK(t.candela == std::vector<double>{2, 4, 6});
    }
    // The ballast-lamp factor went away in 2002.
    CHECK(parseIes(iesText("IESNA91\n", "0", 1, "0.5 0.5 10"), "a.ies").candela[0] == 0.5);
    CHECK(parseIes(iesText("IESNA:LM-63-2002\n", "0", 1, "0.5 0.5 10"), "a.ies").candela[0] == 1);
}

TEST_CASE("IES planes and their symmetry") {
    CHECK(parseIes(iesText("", "0 90", 2), "a").symmetry == PlaneSymmetry::quarter);
    CHECK(parseIes(iesText("", "0 180", 2), "a").symmetry == PlaneSymmetry::half);
    CHECK(parseIes(iesText("", "90 180 270", 3), "a").symmetry == PlaneSymmetry::across);
    CHECK(parseIes(iesText("", "0 180 360", 3), "a").symmetry == PlaneSymmetry::none);
    const IntensityTable open = parseIes(iesText("", "0 90 180 270", 4), "a");
    CHECK(open.symmetry == PlaneSymmetry::none);
    CHECK(open.horizontal.back() == doctest::Approx(360 * kDegree));
    CHECK(open.at(4, 2) == open.at(0, 2));
}

TEST_CASE("a tilt is read past, wherever its lines break; commas separate as blanks do") {
    std::string text = iesText("", "0", 1);
    text.replace(text.find("TILT=NONE"), 9, "TILT=INCLUDE\n1\n3\n0, 45,\n90\n1 0.9 0.8");
    CHECK(parseIes(text, "a").candela == std::vector<double>{2, 4, 6});
}

TEST_CASE("what is wrong with an IES file is said with its line") {
    CHECK(failure("") == "cannot read `a.ies`, line 1: the file ends before its data");
    CHECK(failure("IESNA91\nnothing\n") == "cannot read `a.ies`, line 3: the file ends before its data");
    CHECK(failure(iesText("", "0", 1).substr(0, 55)).find("the file ends before") != std::string::npos);
    CHECK(failure("TILT=lamp.tlt\n").find("only NONE and INCLUDE") != std::string::npos);
    CHECK(failure(iesText("", "0 45", 2)).find("line 6: horizontal angles from 0 to 45") != std::string::npos);
    CHECK(failure(iesText("", "90 0", 2)).find("line 6: a horizontal angle does not increase") != std::string::npos);
    CHECK(failure(iesText("", "x", 1)).find("line 6: a horizontal angle is not a number") != std::string::npos);
    CHECK(failure(iesText("", "nan", 1)).find("is not a number") != std::string::npos);
    CHECK(failure(iesText("", "0", 1, "1 1 10", "-2")).find("a factor is negative") != std::string::npos);
    CHECK(failure(iesText("", "0", 1, "1 1 10", "1e400")).find("the candela multiplier is not a number") !=
          std::string::npos);
    std::string text = iesText("", "0", 1);
    text.replace(text.find(" 3 1 1 2"), 8, " 3 1 2 2");
    CHECK(failure(text) == "cannot read `a.ies`, line 3: photometric type 2, not 1 (type C)");
    text = iesText("", "0", 1);
    text.replace(text.find(" 3 1 1 2"), 8, " 3e9 1 1 2");
    CHECK(failure(text).find("the number of vertical angles is 3000000000") != std::string::npos);
    text = iesText("", "0", 1);
    text.replace(text.rfind("2 3"), 1, "-2");
    CHECK(failure(text) == "cannot read `a.ies`, line 7: an intensity is negative or too large");
    text = iesText("", "0", 1);
    text.replace(text.find("0 45 90"), 7, "-90 0 90");
    CHECK(failure(text).find("line 5: the vertical angles leave 0 to 180") != std::string::npos);
}

TEST_CASE("damaged IES files are refused or read, never worse") {
    const std::string sound = iesText("IESNA91\n", "0 45 90", 3);
    test::Random random(7);
    const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random.uniform() * static_cast<float>(n)); };
    int refused = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string text = sound.substr(0, i % 3 == 0 ? pick(sound.size() + 1) : sound.size());
        for (std::size_t k = pick(4); k > 0 && !text.empty(); --k) {
            const std::string alphabet = "0123456789.-+eE ,\n\r\t=aN\0\xff";
            text[pick(text.size())] = alphabet[pick(alphabet.size())];
        }
        try {
            const IntensityTable t = parseIes(text, "a");
            CHECK(t.candela.size() == t.vertical.size() * t.horizontal.size());
            for (const double c : t.candela) CHECK((c >= 0 && std::isfinite(c)));
        } catch (const IoError&) {
            ++refused;
        }
    }
    CHECK(refused > 5000);
}

} // namespace abbe

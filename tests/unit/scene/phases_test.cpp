// Phase functions in the language: what is accepted, and what is said about what is not.
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <fstream>

namespace abbe::test {
namespace {

constexpr const char* kRest = "camera { from 0 0 4; look-at 0 0 0 }\nlight sky\n"
                              "shape sphere { material boundary; interior homogeneous { phase p } }\n";

TestScene scene(const std::string& phases) { return TestScene::parse("scene 1\n" + phases + "\n" + kRest); }

// The one medium's value straight on and straight back, times 4π.
std::pair<double, double> ends(const std::string& phases) {
    const TestScene s = scene(phases);
    const PhaseFunction& phase = s.scene().media.at(0)->phase();
    return {4 * kPiD * static_cast<double>(phase.value(1)), 4 * kPiD * static_cast<double>(phase.value(-1))};
}

// Codes of the diagnostics.
std::string phaseFaults(const std::string& phases) {
    const TestScene s = scene(phases);
    std::string all;
    for (const Diagnostic& d : s.diagnostics().all()) all += (all.empty() ? "" : " ") + d.code;
    return all;
}
std::string report(const std::string& phases) { return scene(phases).report(); }
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("a table in rows or in a file, relative values") {
    const auto [on, back] = ends("phase p table { values { - 0 6; - 180 2 } }");
    CHECK(on == doctest::Approx(1.5));
    CHECK(back == doctest::Approx(0.5));
    const auto path = std::filesystem::temp_directory_path() / "abbe_phase_test.csv";
    std::ofstream(path) << "angle,value\n# comment\n0,3e300\n180;1e300\n";
    const auto file = ends("phase p table \"" + path.string() + "\"");
    CHECK(file.first == doctest::Approx(1.5));
    std::ofstream(path) << "0 1\n50 1\n40 1\n180 1\n";
    const std::string text = report("phase p table \"" + path.string() + "\"");
    CHECK(has(text, "E0648"));
    std::filesystem::remove(path);
}

TEST_CASE("what is wrong with a table is said where it stands") {
    const auto table = [](const std::string& rows) { return phaseFaults("phase p table { values { " + rows + " } }"); };
    CHECK(table("- 0 1; - 90 2; - 180 1") == "");
    CHECK(table("- 0 1; - 90 2; - 90 3; - 180 1") == "E0648");
    CHECK(table("- 0 1; - 120 2; - 90 3; - 180 1") == "E0648");
    CHECK(table("- 0 1; - 90 -2; - 180 1") == "E0648");
    CHECK(table("- 0 1; - 90 #inf; - 180 1") == "E0648");
    CHECK(table("- 0 1; - 90 #nan; - 180 1") == "E0648");
    CHECK(table("- 0 0; - 180 0") == "E0648");
    CHECK(table("- 5 1; - 180 1") == "E0648");
    CHECK(table("- 0 1; - 170 1") == "E0648");
    CHECK(table("- 0 1; - 270 1") == "E0648");
    CHECK(table("- 0 1") == "E0648");
    CHECK(table("- 0 1 2; - 180 1") == "E0648");
    CHECK(table("- 0 high; - 180 1") == "E0648");
    CHECK(phaseFaults("phase p table") == "E0207");
    CHECK(phaseFaults("phase p table \"nothing-there.csv\"") == "E0401");
    CHECK(phaseFaults("phase p table \"README.md\"") == "E0402");
    CHECK(has(report("phase p table { values { - 0 1\n- 90 -2\n- 180 1 } }"), ":3:"));
}

TEST_CASE("a mix of named and inline parts, nested") {
    const auto [on, back] = ends("phase p mix { part slope weight=3; part table { values { - 0 0; - 180 2 } } }\n"
                                 "phase slope table { values { - 0 2; - 180 0 } }");
    CHECK(on == doctest::Approx(1.5));
    CHECK(back == doctest::Approx(0.5));
    const auto nested = ends("phase p mix { part q; part isotropic }\n"
                             "phase q mix { part table weight=0.5 { values { - 0 2; - 180 0 } } }");
    CHECK(nested.first == doctest::Approx(1.5));
    CHECK(phaseFaults(
              "phase p mix { part henyey-greenstein 0.5 weight=0.3; part henyey-greenstein g=0.1 weight=0.3 }") == "");
}

TEST_CASE("what is wrong with a mix") {
    CHECK(phaseFaults("phase p mix") == "E0207");
    CHECK(phaseFaults("phase p mix { part p }") == "E0649");
    CHECK(phaseFaults("phase p mix { part q; part isotropic }\nphase q mix { part r }\nphase r mix { part p }") ==
          "E0649");
    CHECK(phaseFaults("phase p mix { part isotropic weight=0 }") == "E0649");
    CHECK(phaseFaults("phase p mix { part isotropic weight=-1 }") == "E0303");
    CHECK(phaseFaults("phase p mix { part isotropic weight=much }") == "E0303");
    CHECK(phaseFaults("phase p mix { part isotropic wieght=1 }") == "E0210");
    CHECK(phaseFaults("phase p mix { part nothing weight=1 }") == "E0202");
    CHECK(phaseFaults("phase p mix { part }") == "E0306");
}

TEST_CASE("drops: defaults, an argument, limits with advice") {
    CHECK(phaseFaults("phase p mie") == "");
    CHECK(phaseFaults("phase p mie 2 um") == "");
    CHECK(phaseFaults("phase p mie { radius 300 nm; spread 50 %; ior 1.46; k 0.01; surroundings glass water }") == "");
    CHECK(scene("phase p mie 2 um").scene().media.at(0)->phase().spectral());
    CHECK(has(report("phase p mie 2"), "E0303"));
    CHECK(has(report("phase p mie { radius 2 mm }"), "E0303"));
    CHECK(phaseFaults("phase p mie { spread -0.1 }") == "E0303");
    CHECK(phaseFaults("phase p mie { ior rgb 1 1 1 }") == "E0311");
}

TEST_CASE("properties on the line of a definition: key=value") {
    const auto [on, back] = ends("phase p henyey-greenstein g=0.5");
    CHECK(on == doctest::Approx(6));
    CHECK(back == doctest::Approx(0.5 * 0.75 / std::pow(1.5, 3) * 2));
    const TestScene inlined = TestScene::parse(
        "scene 1\ncamera { from 0 0 4; look-at 0 0 0 }\nlight sky\nshape sphere radius=0.5 { material boundary; "
        "interior homogeneous extinction=2 { phase henyey-greenstein g=0.5 } }\n");
    CHECK(4 * kPiD * static_cast<double>(inlined.scene().media.at(0)->phase().value(1)) == doctest::Approx(6));
    CHECK(inlined.scene().media.at(0)->extinction().at(550.0) == doctest::Approx(2));
    CHECK(phaseFaults("phase p henyey-greenstein h=0.5") == "E0210");
    CHECK(phaseFaults("phase p henyey-greenstein g=1.5") == "E0303");
    CHECK(phaseFaults("phase p henyey-greenstein g=much") == "E0314");
    CHECK(phaseFaults("phase p henyey-greenstein 0.5 g=0.5") == "E0208");
    CHECK(phaseFaults("phase p henyey-greenstein g=0.5 { g 0.6 }") == "E0208");
}

} // namespace abbe::test

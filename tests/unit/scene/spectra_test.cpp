// The values of a scene as curves: what the words of the language mean in numbers.
#include "scene_test_fixture.h"
#include "spectrum/sensor.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// Radiance of the only area light, as written after `radiance`.
const Curve* emission(const TestScene& scene) {
    REQUIRE(scene.report() == "");
    for (const auto& c : scene.scene().curves)
        if (!(c->isConstant() && c->at(500.0) == 0.5)) return c.get(); // the other one is the default material's
    return nullptr;
}

TestScene emitter(const std::string& radiance) {
    return TestScene::parse(kEye + "shape sphere { radius 1; emission " + radiance + " }");
}

const Curve* glass(const TestScene& scene) {
    REQUIRE(scene.report() == "");
    for (const auto& c : scene.scene().curves)
        if (c->minimum() > 1.2 && c->maximum() < 3) return c.get();
    return nullptr;
}

} // namespace

TEST_CASE("spectra: numbers, tables, lines") {
    const auto flat = emitter("2.5");
    CHECK(emission(flat)->at(400) == 2.5);
    CHECK(emission(flat)->isConstant());
    const auto table = emitter("table 400 1  600 3");
    CHECK(emission(table)->at(500) == doctest::Approx(2).epsilon(1e-6));
    const auto black = emitter("blackbody 3000 K");
    // Planck's law in W·m⁻²·sr⁻¹·nm⁻¹ at 600 nm.
    const double h = 6.62607015e-34, c = 299792458, k = 1.380649e-23, l = 600e-9;
    const double planck = 2 * h * c * c / std::pow(l, 5) / std::expm1(h * c / (l * k * 3000)) * 1e-9;
    CHECK(emission(black)->at(600) == doctest::Approx(planck).epsilon(1e-4));
}

TEST_CASE("spectra: refractive indices of glasses") {
    const auto bk7 = build("shape sphere { material dielectric { ior glass BK7 } }");
    REQUIRE(glass(bk7));
    CHECK(glass(bk7)->at(587.56) == doctest::Approx(1.5168).epsilon(2e-5));
    CHECK(glass(bk7)->at(486.13) - glass(bk7)->at(656.27) == doctest::Approx(0.5168 / 64.17).epsilon(2e-3));
    const auto cauchy = build("shape sphere { material dielectric { ior cauchy 1.5 0.004 } }");
    REQUIRE(glass(cauchy));
    CHECK(glass(cauchy)->at(500) == doctest::Approx(1.5 + 0.004 / 0.25));
    const auto sellmeier = build("shape sphere { material dielectric { ior sellmeier 1.03961212 0.00600069867 "
                                 "0.231792344 0.0200179144 1.01046945 103.560653 } }");
    REQUIRE(glass(sellmeier));
    CHECK(glass(sellmeier)->at(587.56) == doctest::Approx(1.5168).epsilon(2e-5));
}

TEST_CASE("spectra: what cannot be is said, with a suggestion") {
    const auto scene = build("shape sphere { material dielectric { ior glass BK77 } }");
    REQUIRE(scene.diagnostics().hasErrors());
    const Diagnostic& d = scene.diagnostics().all().front();
    CHECK((d.help + d.label + d.message).find("BK7") != std::string::npos);
    CHECK(build("shape sphere { material conductor { index metal Unobtainium } }").diagnostics().hasErrors());
    CHECK(build("shape sphere { material diffuse { reflectance 1.5 } }").diagnostics().hasErrors());
    CHECK(build("shape sphere { material diffuse { reflectance illuminant D65 } }").diagnostics().hasErrors());
}

TEST_CASE("spectra: rgb white is exactly flat, and colours come back") {
    const auto of = [](const std::string& text) {
        return build("material m diffuse { reflectance " + text + " }\nshape sphere { material m }");
    };
    const auto white = of("rgb 1 1 1");
    REQUIRE(white.report() == "");
    const Curve& w = *white.scene().curves.back();
    for (double nm = 360; nm <= 830; nm += 10) CHECK(w.at(nm) == doctest::Approx(1).epsilon(1e-6));
    const auto red = of("rgb 0.7 0.1 0.1");
    const Curve& r = *red.scene().curves.back();
    CHECK(r.minimum() >= 0);
    CHECK(r.maximum() <= 1);
    CHECK(r.at(650) > 3 * r.at(500));
}

TEST_CASE("amounts: lumens, candelas, lux and nits") {
    const auto light = [](const std::string& text) {
        const auto scene = TestScene::parse(kEye + text);
        INFO(scene.report());
        REQUIRE_FALSE(scene.diagnostics().hasErrors());
        return scene.built().facts.lightList.front().watts;
    };
    // A flat spectrum of 1 W/nm over 470 nm has 683 · 106.857 lm.
    const double wattsPerLumen = 470 / (kLuminousEfficacy * kYIntegral);
    CHECK(light("light point { power 800 lm; color 1 }") == doctest::Approx(800 * wattsPerLumen).epsilon(1e-4));
    CHECK(light("light point { power 5 W; color 1 }") == doctest::Approx(5).epsilon(1e-5));
    CHECK(light("light point { intensity 10 cd; color 1 }") ==
          doctest::Approx(40 * kPiD * wattsPerLumen).epsilon(1e-4));
    CHECK(light("light sphere { radius 0.5; power 7 W }") == doctest::Approx(7).epsilon(1e-5));
    CHECK(light("light quad { size 2 3; luminance 100 nits; color 1 }") ==
          doctest::Approx(kPiD * 6 * 100 * wattsPerLumen).epsilon(1e-4));
    CHECK(light("light disk { radius 2; radiance 0.5 }") == doctest::Approx(kPiD * kPiD * 4 * 0.5 * 470).epsilon(1e-4));
}

TEST_CASE("amounts: none, two, and impossible ones") {
    CHECK(codes(TestScene::parse(kEye + "light point { color 1 }")).find("E0340") != std::string::npos);
    CHECK(TestScene::parse(kEye + "light point { power 1 W; intensity 3 cd }").diagnostics().hasErrors());
    CHECK(TestScene::parse(kEye + "light point { power 1 kg }").diagnostics().hasErrors());
    CHECK(TestScene::parse(kEye + "light point { power -5 W }").diagnostics().hasErrors());
}

TEST_CASE("environment: missing and damaged images") {
    const auto missing = build("light environment \"no/such.exr\"");
    REQUIRE(missing.diagnostics().hasErrors());
    CHECK(missing.diagnostics().all().front().span.valid());
}

} // namespace abbe::test

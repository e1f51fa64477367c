// Amounts of light against values worked out by hand.
#include "lights/amount.h"
#include "lights/area_light_types.h"
#include "lights/point_light.h"
#include "lights/spot_light.h"
#include "spectrum/curve.h"
#include "spectrum/sensor.h"

#include <cmath>
#include <doctest/doctest.h>
#include <set>

namespace abbe {
namespace {

using schema::Dimension;
using schema::Quantity;

// Like a light: rising to red, at an odd scale.
const SampledCurve kAmountSpectrum([](double nm) { return 37 * std::exp((nm - 360) / 200); });
// 1 W within ±1 nm of 555 nm.
const SampledCurve kGreenLine([](double nm) { return nm == 555 ? 1.0 : 0.0; });
const SampledCurve kInfrared([](double nm) { return nm == 830 ? 1.0 : 0.0; });
const SampledCurve kDark([](double) { return 0.0; });

double scale(Quantity q, const Curve& shape, double factor) { return scaleFor(q, shape, factor).value(); }

TEST_CASE("integrals of a spectrum") {
    CHECK(radiantIntegral(ConstantCurve(2)) == doctest::Approx(940).epsilon(1e-12));
    CHECK(radiantIntegral(kAmountSpectrum) == doctest::Approx(37 * 200 * (std::exp(2.35) - 1)).epsilon(1e-5));
    // One watt of 555 nm is 683 lm.
    CHECK(luminousIntegral(kGreenLine) / radiantIntegral(kGreenLine) == doctest::Approx(683).epsilon(1e-3));
    CHECK(luminousIntegral(ConstantCurve(1)) == doctest::Approx(683 * 106.8569).epsilon(1e-5));
}

TEST_CASE("a panel of 60 cm by 120 cm with 2400 lm has 1061 nits") {
    const double k = scale({2400, Dimension::luminousFlux, {}}, kAmountSpectrum, kPiD * 0.6 * 1.2);
    CHECK(k * luminousIntegral(kAmountSpectrum) == doctest::Approx(1061.03).epsilon(1e-5));
    CHECK(scale({1061.03, Dimension::luminance, {}}, kAmountSpectrum, 1) == doctest::Approx(k).epsilon(1e-5));
}

TEST_CASE("800 lm from a point are 63.66 cd, and watts are watts") {
    const double k = scale({800, Dimension::luminousFlux, {}}, kAmountSpectrum, 4 * kPiD);
    CHECK(k * luminousIntegral(kAmountSpectrum) == doctest::Approx(63.662).epsilon(1e-5));
    const double watts = scale({60, Dimension::power, {}}, kAmountSpectrum, 4 * kPiD);
    CHECK(watts * radiantIntegral(kAmountSpectrum) * 4 * kPiD == doctest::Approx(60));
}

TEST_CASE("light that the spectrum cannot give") {
    CHECK_FALSE(scaleFor({1, Dimension::luminousFlux, {}}, kDark, 1).has_value());
    CHECK_FALSE(scaleFor({1, Dimension::power, {}}, kDark, 1).has_value());
    CHECK(scaleFor({1, Dimension::power, {}}, kInfrared, 1).has_value());
}

TEST_CASE("the absolute spectrum of each amount") {
    Diagnostics diagnostics;
    const EmitterFactors factors{.power = 2, .irradiance = 5};
    const ConstantCurve even(1);
    AmountParams p;
    p.color = &kAmountSpectrum;
    p.power = Quantity{10, Dimension::power, {}};
    CHECK(absoluteSpectrum(p, even, factors, {}, diagnostics)->scale ==
          doctest::Approx(5 / radiantIntegral(kAmountSpectrum)));
    p.power.reset();
    p.irradiance = Quantity{10, Dimension::illuminance, {}};
    CHECK(absoluteSpectrum(p, even, factors, {}, diagnostics)->scale ==
          doctest::Approx(2 / luminousIntegral(kAmountSpectrum)));
    p.irradiance.reset();
    p.intensity = Quantity{10, Dimension::luminousIntensity, {}};
    p.color = nullptr;
    const auto onDefault = absoluteSpectrum(p, even, factors, {}, diagnostics);
    CHECK(onDefault->curve == &even);
    CHECK(onDefault->scale == doctest::Approx(10 / luminousIntegral(even)));
    p.intensity.reset();
    p.radiance.curve = &kAmountSpectrum;
    CHECK(absoluteSpectrum(p, even, factors, {}, diagnostics)->scale == 1);
    CHECK(diagnostics.all().empty());
}

TEST_CASE("amounts that contradict themselves are reported") {
    const auto code = [](const AmountParams& p, EmitterFactors factors) {
        Diagnostics diagnostics;
        CHECK_FALSE(absoluteSpectrum(p, kAmountSpectrum, factors, {}, diagnostics).has_value());
        return diagnostics.all().size() == 1 ? diagnostics.all()[0].code : "";
    };
    AmountParams p;
    p.radiance.curve = p.color = &kAmountSpectrum;
    CHECK(code(p, {}) == "E0341");
    p = {};
    p.power = Quantity{1, Dimension::power, {}};
    CHECK(code(p, {.power = 0}) == "E0342");
    CHECK(code(p, {.power = HUGE_VAL}) == "E0342");
    p.color = &kDark;
    CHECK(code(p, {.power = 1}) == "E0343");
}

TEST_CASE("every light says when it states no amount") {
    LightContext context;
    context.defaultColor = &kAmountSpectrum;
    Diagnostics diagnostics;
    CHECK(makePointLight({}, context, diagnostics) == nullptr);
    CHECK(makeSpotLight({}, context, diagnostics) == nullptr);
    REQUIRE(diagnostics.all().size() == 2);
    CHECK(diagnostics.all()[0].code == "E0340");
    CHECK(diagnostics.all()[0].help == "write `power 800 lm` or `intensity 120 cd`");
}

TEST_CASE("fields of the base are stored through the table of the derived type") {
    const schema::TypeInfo type = lightQuadType();
    LightQuadParams params;
    std::set<std::string_view> names;
    for (const schema::FieldInfo& f : type.fields) {
        CHECK(names.insert(f.name).second);
        CHECK_FALSE(f.doc.empty());
        CHECK(f.doc.back() == '.');
        CHECK_FALSE(f.example.empty());
        if (f.name == "power") f.store(&params, Quantity{12, Dimension::power, {}});
        if (f.name == "color") f.store(&params, static_cast<const Curve*>(&kAmountSpectrum));
        if (f.name == "two-sided") f.store(&params, true);
        if (f.name == "size") f.store(&params, Vec2d{2, 3});
    }
    CHECK(params.power->value == 12);
    CHECK(params.color == &kAmountSpectrum);
    CHECK(params.twoSided);
    CHECK(params.size == Vec2d{2, 3});
}

} // namespace
} // namespace abbe

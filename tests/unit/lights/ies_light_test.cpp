#include "lights/ies_light.h"
#include "spectrum/curve.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

constexpr double kIesDegree = kPiD / 180;

// Intensities f(vertical, horizontal) every `step` degrees.
template <typename F> IntensityTable table(double lastPlane, PlaneSymmetry symmetry, F f, double firstPlane = 0) {
    IntensityTable t;
    t.symmetry = symmetry;
    for (int v = 0; v <= 180; v += 1) t.vertical.push_back(v * kIesDegree);
    for (double h = firstPlane; h <= lastPlane; h += 5) t.horizontal.push_back(h * kIesDegree);
    for (const double h : t.horizontal)
        for (const double v : t.vertical) t.candela.push_back(f(v, h));
    return t;
}

double cosineLight(double v, double) { return std::max(100 * std::cos(v), 0.0); }
// Mirrored at both axes.
double oblong(double v, double h) { return 20 + 50 * square(std::sin(v) * std::cos(h)); }

} // namespace

TEST_CASE("the flux of a light: cosine, sphere, oblong") {
    CHECK(IesProfile(table(0, PlaneSymmetry::axial, cosineLight)).lumens() ==
          doctest::Approx(100 * kPiD).epsilon(1e-4));
    CHECK(IesProfile(table(0, PlaneSymmetry::axial, [](double, double) { return 7.0; })).lumens() ==
          doctest::Approx(28 * kPiD).epsilon(1e-9));
    const double whole = 20 * 4 * kPiD + 50 * 4 * kPiD / 3;
    CHECK(IesProfile(table(90, PlaneSymmetry::quarter, oblong)).lumens() == doctest::Approx(whole).epsilon(1e-3));
    CHECK(IesProfile(table(180, PlaneSymmetry::half, oblong)).lumens() == doctest::Approx(whole).epsilon(1e-3));
    CHECK(IesProfile(table(270, PlaneSymmetry::across, oblong, 90)).lumens() == doctest::Approx(whole).epsilon(1e-3));
    CHECK(IesProfile(table(360, PlaneSymmetry::none, oblong)).lumens() == doctest::Approx(whole).epsilon(1e-3));
}

TEST_CASE("planes are mirrored as the file says") {
    const auto half = [](double v, double h) { return 10 + 5 * std::sin(v) * std::cos(h) + square(std::cos(h)); };
    const auto across = [](double v, double h) { return 10 + 5 * std::sin(v) * std::sin(h); };
    const std::pair<IesProfile, double (*)(double, double)> profiles[] = {
        {IesProfile(table(0, PlaneSymmetry::axial, cosineLight)), cosineLight},
        {IesProfile(table(90, PlaneSymmetry::quarter, oblong)), oblong},
        {IesProfile(table(180, PlaneSymmetry::half, half)), half},
        {IesProfile(table(270, PlaneSymmetry::across, across, 90)), across},
        {IesProfile(table(360, PlaneSymmetry::none, half)), half}};
    for (const auto& [profile, f] : profiles)
        for (double h = -355; h < 720; h += 5)
            for (const double v : {0., 20., 90., 133., 180.})
                CHECK(profile.candela(v * kIesDegree, h * kIesDegree) ==
                      doctest::Approx(f(v * kIesDegree, h * kIesDegree)).epsilon(1e-6).scale(1));
}

TEST_CASE("there is no light beyond the measured angles, and all of it at their ends") {
    IntensityTable t;
    t.vertical = {0, kPiD / 2};
    t.horizontal = {0};
    t.candela = {10, 30};
    const IesProfile profile(t);
    CHECK(profile.candela(kPiD / 2, 1) == 30);
    CHECK(profile.candela(kPiD / 4, -2) == doctest::Approx(20));
    CHECK(profile.candela(kPiD / 2 + 1e-3, 0) == 0);
    CHECK(profile.candela(0, 0) == 10);
}

TEST_CASE("a light that points down, seen from above, counts its planes counter-clockwise") {
    const ConstantCurve unit(1);
    LightContext context;
    context.defaultColor = &unit;
    for (const bool zUp : {false, true}) {
        context.zUp = zUp;
        IesLightParams params;
        params.power = schema::Quantity{470, schema::Dimension::power, {}};
        const auto bright = [](double v, double h) { return std::sin(v) * (std::abs(h - kPiD / 2) < 0.2 ? 1.0 : 0.1); };
        Diagnostics diagnostics;
        const auto light = makeIesLight(params, table(360, PlaneSymmetry::none, bright), context, diagnostics);
        REQUIRE(light);
        CHECK(light->power() == doctest::Approx(470));
        const Wavelengths at = Wavelengths::single(550);
        const auto radiance = [&](Vec3 from) { return light->sample(from, 0, {}, at, 0)->radiance[0]; };
        // The plane of 90° is a quarter turn counter-clockwise from +x.
        const Vec3 ninety = zUp ? Vec3{0, 1, 0} : Vec3{0, 0, -1};
        CHECK(radiance(ninety) > 5 * radiance(-ninety));
        CHECK(radiance(ninety) > 5 * radiance({1, 0, 0}));
        params.turn = kPiD / 2;
        const auto turned = makeIesLight(params, table(360, PlaneSymmetry::none, bright), context, diagnostics);
        CHECK(turned->sample(Vec3{-1, 0, 0}, 0, {}, at, 0)->radiance[0] ==
              doctest::Approx(radiance(ninety)).epsilon(1e-5));
        params.turn = 0;
        params.toward = Vec3d{0.3, -0.5, 0.2};
        const auto tilted = makeIesLight(params, table(0, PlaneSymmetry::axial, cosineLight), context, diagnostics);
        const Vec3 axis = normalize(Vec3{0.3f, -0.5f, 0.2f});
        CHECK(tilted->sample(axis, 0, {}, at, 0)->radiance[0] == doctest::Approx(1 / kPiD).epsilon(1e-3));
        CHECK_FALSE(tilted->sample(-axis, 0, {}, at, 0));
    }
}

TEST_CASE("dark lights are left out, or refused if they state a power") {
    const ConstantCurve unit(1);
    LightContext context;
    context.defaultColor = &unit;
    IesLightParams params;
    const IntensityTable dark = table(0, PlaneSymmetry::axial, [](double, double) { return 0.0; });
    Diagnostics diagnostics;
    CHECK_FALSE(makeIesLight(params, dark, context, diagnostics));
    CHECK(diagnostics.all().back().code == "W0750");
    params.power = schema::Quantity{1, schema::Dimension::power, {}};
    CHECK_FALSE(makeIesLight(params, dark, context, diagnostics));
    CHECK(diagnostics.all().back().code == "E0751");
}

} // namespace abbe

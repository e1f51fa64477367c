#include "spectrum/color_space.h"
#include "spectrum/curve.h"
#include "spectrum/emission_curves.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"
#include "spectrum/wavelength_density.h"
#include "support/chi_square.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace abbe;

namespace {

std::vector<double> nodes(const Curve& c) {
    std::vector<double> values;
    for (int i = 0; i < WavelengthDensity::kNodes; ++i) values.push_back(c.at(360.0 + i));
    return values;
}
std::vector<double> illuminant(std::string_view name) { return nodes(*illuminantCurve(findIlluminant(name).value())); }
std::vector<double> line(double nm) { return nodes(*lineCurve(nm)); }
std::vector<double> band(double middle, double width) {
    return nodes(SampledCurve([=](double nm) { return std::exp(-0.5 * square((nm - middle) / width)); }));
}

// Lights at both ends of what there is.
std::vector<std::vector<double>> lights() {
    return {illuminant("FL11"), illuminant("sodium-low-pressure"), line(632.8), line(360), line(830), band(470, 5),
            illuminant("D65"),  std::vector<double>(471, 1)};
}

} // namespace

// Hard case 46.
TEST_CASE("tabulated wavelengths: the density is nowhere 0 and integrates to one") {
    for (const auto& power : lights()) {
        const WavelengthDensity density = WavelengthDensity::following(power);
        double sum = 0, least = 1;
        for (int i = 0; i < 470; ++i) // linear in each nanometre
            sum += 0.5 * (density.pdf(360 + i) + density.pdf(361 + i));
        for (int i = 0; i <= 4700; ++i) least = std::min(least, density.pdf(360 + 0.1 * i));
        CHECK(sum == doctest::Approx(1).epsilon(1e-6));
        CHECK(least > 1e-8);
    }
}

TEST_CASE("tabulated wavelengths are quantiles of their density, and carry it") {
    for (const auto& power : lights()) {
        const WavelengthDensity density = WavelengthDensity::following(power);
        std::vector<double> cumulative{0};
        for (int i = 0; i < 470; ++i)
            cumulative.push_back(cumulative.back() + 0.5 * (density.pdf(360 + i) + density.pdf(361 + i)));
        for (int i = 0; i < 4000; ++i) {
            const double u = (i + 0.37) / 4000;
            const Wavelengths w = density.sample(u);
            for (int lane = 0; lane < kLanes; ++lane) {
                REQUIRE(w.nm[lane] >= 360);
                REQUIRE(w.nm[lane] <= 830);
                const auto cell = static_cast<std::size_t>(w.cell[lane]);
                const double f = w.fraction[lane], a = density.pdf(360.0 + w.cell[lane]);
                const double below = cumulative[cell] + f * 0.5 * (a + density.pdf(w.nm[lane]));
                const double gap = std::abs(below - std::fmod(u + lane / 8.0, 1.0));
                // A wavelength is rounded to 6e-5 nm.
                REQUIRE(std::min(gap, 1 - gap) < 1e-12 + 1e-4 * density.pdf(w.nm[lane]));
                REQUIRE(w.pdf[lane] == doctest::Approx(density.pdf(w.nm[lane])).epsilon(1e-5));
            }
        }
    }
}

TEST_CASE("tabulated wavelengths follow their density: χ² over tenths of nanometres") {
    for (const auto& power : lights()) {
        const WavelengthDensity density = WavelengthDensity::following(power);
        const int samples = test::chiSquareSamples();
        std::vector<double> observed(4700), expected;
        for (int i = 0; i < 4700; ++i) // linear in each
            expected.push_back(0.1 * samples * density.pdf(360 + 0.1 * i + 0.05));
        test::Random random(11);
        for (int i = 0; i < samples; ++i) {
            const Wavelengths w = density.sample(random.uniform());
            const int lane = i % kLanes; // one of each path: they depend on each other
            const int bin = w.cell[lane] * 10 + static_cast<int>(w.fraction[lane] * 10);
            ++observed[static_cast<std::size_t>(std::min(bin, 4699))];
        }
        CHECK(test::chiSquareTest(observed, expected).pValue > 1e-4);
    }
}

// A bin of a spectral layer is a sum of 1/p over the wavelengths within it, and some nanometres are less likely than
// one number in a million: neither numbers of 24 bits nor a cumulative in float know where they begin.
TEST_CASE("tabulated wavelengths: the mean of 1/p over the numbers of every nanometre is its width") {
    for (const auto& power : lights()) {
        const WavelengthDensity density = WavelengthDensity::following(power);
        constexpr int n = 1000;
        double below = 0, worst = 0;
        for (int cell = 0; cell < 470; ++cell) {
            const double share = 0.5 * (density.pdf(360 + cell) + density.pdf(361 + cell));
            double width = 0;
            for (int i = 0; i < n; ++i) { // closer together at both ends, where 1/p may be steep
                const double s = (i + 0.5) / n, at = below + s * s * (3 - 2 * s) * share;
                const Wavelengths w = density.sample(std::min(at, 1 - 0x1p-53));
                if (w.cell[0] == cell) width += 6 * s * (1 - s) * share / n / static_cast<double>(w.pdf[0]);
            }
            worst = std::max(worst, std::abs(width - 1));
            below += share;
        }
        CHECK(worst < 1e-3);
    }
}

TEST_CASE("tabulated wavelengths of which bins are shown starve none of them") {
    for (const auto& power : lights()) {
        const WavelengthDensity plain = WavelengthDensity::following(power),
                                shown = WavelengthDensity::following(power, WavelengthDensity::Shown{370.5, 780});
        for (double nm = 370.5; nm <= 780; nm += 0.25) REQUIRE(shown.pdf(nm) > 0.5 / 411);
        for (double nm = 360; nm <= 830; nm += 0.25) REQUIRE(shown.pdf(nm) >= 0.4999 * plain.pdf(nm));
        CHECK(shown.pdf(800) == doctest::Approx(0.5 * plain.pdf(800)));
    }
}

// What is rendered does not depend on the density: an equal-energy white, and the lights themselves.
TEST_CASE("colours are the same whatever the density") {
    constexpr int n = 1 << 16;
    for (const auto& power : lights()) {
        const WavelengthDensity density = WavelengthDensity::following(power);
        const SampledCurve light([&](double nm) { return power[static_cast<std::size_t>(nm - 360)]; });
        Xyz white, lit;
        for (int i = 0; i < n; ++i) { // a period of the rotations
            const Wavelengths w = density.sample((static_cast<float>(i) + 0.5f) / (8 * n));
            white += toXyz(Spectrum(1.f), w) * (1.0 / n);
            lit += toXyz(light.at(w), w) * (1.0 / n);
        }
        const Xyz e = integrate(ConstantCurve(1)), l = integrate(light);
        for (const auto& [got, want] : {std::pair{white, e}, {lit, l}}) {
            CHECK(got.x == doctest::Approx(want.x).epsilon(1e-4));
            CHECK(got.y == doctest::Approx(want.y).epsilon(1e-4));
            CHECK(got.z == doctest::Approx(want.z).epsilon(1e-4).scale(std::max(want.y, 1e-3)));
        }
    }
}

TEST_CASE("the smooth density stays that of Wavelengths::sample, bit for bit") {
    const WavelengthDensity density = WavelengthDensity::bestFor(illuminant("D65"));
    for (int i = 0; i < 1024; ++i) {
        const float u = static_cast<float>(i) / 1024; // of 24 bits, as the sampler's; finer ones are left out
        const Wavelengths a = density.sample(static_cast<double>(u) + 0x1p-25), b = Wavelengths::sample(u);
        for (int lane = 0; lane < kLanes; ++lane) {
            REQUIRE(a.nm[lane] == b.nm[lane]);
            REQUIRE(a.pdf[lane] == b.pdf[lane]);
            REQUIRE(density.pdf(a.nm[lane]) == doctest::Approx(a.pdf[lane]).epsilon(1e-4));
        }
    }
    CHECK_FALSE(WavelengthDensity::bestFor(std::vector<double>(471, 0)).followsLights());
}

// The choice, and what it is worth: docs/performance.md has the table.
TEST_CASE("lines and narrow bands get a table, smooth lights do not") {
    struct Case {
        std::string name;
        std::vector<double> power;
        bool table;
        double atMost; // noise with what is chosen
    };
    std::vector<Case> cases;
    for (const char* name : {"D65", "A", "E", "LED-B1", "LED-V1", "LED-phosphor-YAG", "xenon-projector"})
        cases.push_back({name, illuminant(name), false, 0.19});
    for (const char* name : {"FL2", "FL11", "FL12", "LED-RGB1", "mercury", "sodium-low-pressure"})
        cases.push_back({name, illuminant(name), true, 0.17});
    for (const double kelvin : {1500., 2700., 10000.})
        cases.push_back({fmt::format("blackbody {}", kelvin), nodes(*blackbodyCurve(kelvin)), false, 0.12});
    for (const double nm : {450., 532., 632.8}) cases.push_back({fmt::format("line {}", nm), line(nm), true, 0.07});
    cases.push_back({"band 550 5", band(550, 5), true, 0.07});
    for (const Case& c : cases) {
        CAPTURE(c.name);
        const WavelengthDensity best = WavelengthDensity::bestFor(c.power);
        CHECK(best.followsLights() == c.table);
        CHECK(best.noise(c.power) < c.atMost);
        MESSAGE(fmt::format("{:20} sech² {:.3f}  table {:.3f}", c.name, WavelengthDensity().noise(c.power),
                            WavelengthDensity::following(c.power).noise(c.power)));
    }
}

// What the choice rests on, by a finer and plainer sum: every colour on its own, in double.
TEST_CASE("the noise that decides about the table is that of many more paths") {
    const auto slow = [](const WavelengthDensity& density, const std::vector<double>& power) {
        constexpr int kPaths = 2048;
        const double most = *std::max_element(power.begin(), power.end());
        double total = 0;
        for (int kind = 0; kind < 6; ++kind) {
            const SampledCurve seen([&](double nm) {
                const double red = 1 / (1 + std::exp((590 - nm) / 12));
                const double reflectance = kind == 0   ? 1
                                           : kind == 1 ? (nm < 580 ? 0.05 : 0.9)
                                           : kind == 2 ? (nm < 500 ? 0.9 : 0.05)
                                           : kind == 3 ? (nm > 500 && nm < 580 ? 0.8 : 0.05)
                                           : kind == 4 ? 0.02 + 0.88 * std::pow(red, 4)
                                                       : 0.1 + 0.8 * std::exp(-0.5 * square((nm - 540) / 30));
                return power[static_cast<std::size_t>(nm - 360)] / most * reflectance;
            });
            Vec3d sum;
            double squares = 0;
            for (int i = 0; i < kPaths; ++i) {
                const Wavelengths w = density.sample((static_cast<float>(i) + 0.5f) / (kLanes * kPaths));
                const Vec3d colour = toRgb(toXyz(seen.at(w), w), rgb::ap0);
                sum += colour;
                squares += dot(colour, colour);
            }
            total += std::max(0.0, squares * kPaths / dot(sum, sum) - 1);
        }
        return std::sqrt(total / 6);
    };
    std::vector<std::vector<double>> powers = lights();
    for (const char* name : {"FL2", "FL12", "LED-RGB1", "mercury", "xenon-projector", "A"})
        powers.push_back(illuminant(name));
    for (const double width : {1., 2., 8., 12., 16., 24., 40.}) powers.push_back(band(550, width));
    for (const auto& power : powers) {
        const WavelengthDensity smooth, table = WavelengthDensity::following(power);
        const double a = slow(smooth, power), b = slow(table, power);
        CAPTURE(a);
        CAPTURE(b);
        if (a < 2) CHECK(smooth.noise(power) == doctest::Approx(a).epsilon(0.02)); // more: one path in a thousand
        CHECK(table.noise(power) == doctest::Approx(b).epsilon(0.02));
        CHECK(WavelengthDensity::bestFor(power).followsLights() == (b < 0.7 * a));
    }
}

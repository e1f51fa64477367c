// Lorenz-Mie theory: published values, limits, and the phase function made of it.
#include "media/mie_phase.h"
#include "media/mie_spheres.h"
#include "media/phase_functions.h"
#include "spectrum/curve.h"
#include "spectrum/named_spectra.h"
#include "support/phase_check.h"

namespace abbe::test {

TEST_CASE("efficiencies and asymmetry of one sphere are those of the literature") {
    struct Case {
        double size;
        std::complex<double> index;
        double extinction, scattering, asymmetry;
    };
    // [Wiscombe1979], tables of test cases; the last digit may differ by rounding. At sizes of a thousand and more they
    // fail if the logarithmic derivative begins too near.
    for (const Case& c : {
             Case{10, {1.5, 0}, 2.881999, 2.881999, 0.742913},
             Case{100, {1.5, 0}, 2.094388, 2.094388, 0.818246},
             Case{1000, {1.5, 0}, 2.013945, 2.013945, 0.827882},
             Case{1, {1.33, 1e-5}, 0.093952, 0.093923, 0.184517},
             Case{100, {1.33, 1e-5}, 2.101321, 2.096594, 0.868959},
             Case{10000, {1.33, 1e-5}, 2.004089, 1.723857, 0.907840},
             Case{1, {1.5, 1}, 2.336321, 0.663454, 0.192136},
             Case{100, {1.5, 1}, 2.097502, 1.283697, 0.850252},
             Case{10000, {1.5, 1}, 2.004368, 1.236574, 0.846309},
             Case{1, {10, 10}, 2.532993, 2.049405, -0.110664},
             Case{100, {10, 10}, 2.071124, 1.836785, 0.556215},
             Case{10, {0.75, 0}, 2.232265, 2.232265, 0.896473},
             Case{1000, {0.75, 0}, 1.997908, 1.997908, 0.844944},
         }) {
        INFO(c.size);
        INFO(c.index.real());
        const MieSeries s = mieSeries(c.size, c.index);
        CHECK(std::abs(s.extinction - c.extinction) < 1.1e-6);
        CHECK(std::abs(s.scattering - c.scattering) < 1.1e-6);
        CHECK(std::abs(s.asymmetry - c.asymmetry) < 1.1e-6);
    }
    // The example of [BohrenHuffman1983, appendix A]: radius 0.525 µm, 632.8 nm, index 1.55; back-scattering too.
    const MieSeries book = mieSeries(2 * kPiD * 0.525 / 0.6328, 1.55);
    CHECK(std::abs(book.extinction - 3.10543) < 6e-6);
    const double radius[] = {0.525e-6}, back[] = {kPiD};
    CHECK(std::abs(4 * kPiD * mieScattering(radius, 0.6328e-6, 1.55, back).intensity[0] - 2.92534) < 6e-6);
}

TEST_CASE("limits: Rayleigh's law, twice the shadow, and nothing lost without absorption") {
    const double size = 0.01, m2 = square(1.33);
    const MieSeries small = mieSeries(size, 1.33);
    CHECK(small.scattering / (8.0 / 3 * std::pow(size, 4) * square((m2 - 1) / (m2 + 2))) ==
          doctest::Approx(1).epsilon(1e-4));
    CHECK(small.asymmetry < 1e-4);
    CHECK(mieSeries(5000, {1.4, 0.1}).extinction == doctest::Approx(2).epsilon(0.01));
    for (const double x : {0.02, 0.7, 3.0, 31.0, 400.0, 3000.0}) {
        INFO(x);
        const MieSeries s = mieSeries(x, 1.33);
        CHECK(s.extinction / s.scattering == doctest::Approx(1).epsilon(1e-9));
    }
    const MieSeries absorbing = mieSeries(30, {1.33, 0.01});
    CHECK(absorbing.scattering < 0.8 * absorbing.extinction);
}

TEST_CASE("the intensity of one sphere: its integral is the efficiency, its mean cosine that of the series") {
    const double radii[] = {1e-6};
    std::vector<double> angles;
    for (int i = 0; i <= 20'000; ++i) angles.push_back(kPiD * i / 20'000);
    for (const double wavelength : {4e-7, 2e-6, 3e-5}) {
        INFO(wavelength);
        const MieScattering s = mieScattering(radii, wavelength, {1.45, 0.003}, angles);
        double whole = 0, moment = 0;
        for (std::size_t i = 0; i < angles.size(); ++i) {
            const double ring = 2 * kPiD * std::sin(angles[i]) * kPiD / 20'000 * s.intensity[i];
            whole += ring;
            moment += ring * std::cos(angles[i]);
        }
        CHECK(whole / s.scattering == doctest::Approx(1).epsilon(1e-6));
        CHECK(moment / whole == doctest::Approx(s.asymmetry).epsilon(1e-6));
    }
}

TEST_CASE("radii: mean and spread are weighed by cross-section") {
    const std::vector<double> radii = DropSizes{8e-6, 0.2}.radii(2000);
    double mean = 0, variance = 0;
    for (const double r : radii) mean += r / 2000;
    for (const double r : radii) variance += square(r - mean) / 2000;
    CHECK(mean / 8e-6 == doctest::Approx(1).epsilon(1e-3));
    CHECK(std::sqrt(variance) / mean == doctest::Approx(0.2).epsilon(0.01));
    CHECK(DropSizes{8e-6, 0}.radii(2000) == std::vector<double>{8e-6});
}

namespace {

struct MieCase {
    DropSizes sizes;
    double width, accuracy;
};

} // namespace

TEST_CASE(
    "the phase function of drops: normalised at every wavelength, sampled exactly, with the mean cosine of theory") {
    const auto water = indexCurve(*findGlass("water"));
    for (const MieCase& c : {MieCase{{1e-8, 0}, 0.05, 1e-3}, MieCase{{0.3e-6, 0.4}, 0.05, 1e-3},
                             MieCase{{2e-6, 0.0}, 0.05, 1e-3}, MieCase{{10e-6, 0.2}, 0.004, 2e-3}}) {
        INFO(c.sizes.radius);
        const MiePhase phase({c.sizes, water.get(), nullptr, nullptr});
        double meanCosine = 0;
        for (const MiePhase::Facts& f : phase.facts()) {
            CHECK(f.interpolationError < 0.005);
            CHECK(std::abs(f.tableAsymmetry - f.asymmetry) < 0.002);
            CHECK(f.extinction / f.scattering == doctest::Approx(1).epsilon(1e-9));
            meanCosine += f.tableAsymmetry / MiePhase::kWavelengths;
        }
        checkPhase(phase, {c.width, c.accuracy, meanCosine});
        checkRatio(phase, {c.width, c.accuracy, 0});
    }
}

TEST_CASE("drops far smaller than the wavelength scatter as Rayleigh says") {
    const ConstantCurve index(1.33);
    const MiePhase tiny({{2e-9, 0.1}, &index, nullptr, nullptr});
    for (const float c : {-1.f, -0.5f, 0.f, 0.5f, 1.f})
        CHECK(tiny.value(c) / Draine(0, 1).value(c) == doctest::Approx(1).epsilon(1e-3));
}

TEST_CASE("drops of fog have a bow near 140 degrees, red outside, and a glory") {
    const auto water = indexCurve(*findGlass("water"));
    const MiePhase fog({{10e-6, 0.15}, water.get(), nullptr, nullptr});
    const auto at = [&](double degrees) { return fog.value(static_cast<float>(std::cos(degrees * kPiD / 180))); };
    double brightest = 0;
    for (double a = 125; a < 160; a += 0.25)
        if (at(a) > at(brightest == 0 ? 125 : brightest)) brightest = a;
    CHECK(brightest > 138);
    CHECK(brightest < 146);
    CHECK(at(brightest) > 4 * at(128));
    CHECK(at(180) > 3 * at(170));
    const auto ratio = [&](double degrees, float nm) {
        return fog.ratio(static_cast<float>(std::cos(degrees * kPiD / 180)), Wavelengths::single(nm))[0];
    };
    CHECK(ratio(134, 650) > 1.2 * ratio(134, 450));
}

TEST_CASE("the index counts against that of the surroundings, and so does the wavelength") {
    const ConstantCurve water(1.33), fat(1.4630), relative(1.1);
    const MiePhase milk({{0.5e-6, 0.3}, &fat, nullptr, &water});
    const MiePhase same({{0.5e-6 * 1.33, 0.3}, &relative, nullptr, nullptr});
    for (const float c : {-1.f, 0.f, 0.9f, 1.f})
        CHECK(milk.value(c) / same.value(c) == doctest::Approx(1).epsilon(1e-4));
}

TEST_CASE("a mix with drops depends on wavelength, and every wavelength keeps its integral") {
    const auto water = indexCurve(*findGlass("water"));
    const auto drops = std::make_shared<MiePhase>(MiePhase::Spheres{{3e-6, 0.2}, water.get(), nullptr, nullptr});
    const MixedPhase mix({{drops, 0.6}, {std::make_shared<Draine>(0, 1), 0.4}});
    CHECK(mix.spectral());
    double meanCosine = 0;
    for (const MiePhase::Facts& f : drops->facts()) meanCosine += 0.6 * f.tableAsymmetry / MiePhase::kWavelengths;
    checkPhase(mix, {0.02, 2e-3, meanCosine});
    checkRatio(mix, {0.02, 2e-3, 0});
}

} // namespace abbe::test

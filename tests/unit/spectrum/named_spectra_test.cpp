#include "spectrum/dispersion.h"
#include "spectrum/named_spectra.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

struct Catalogue {
    const char* name;
    double nd, abbe;
};

// SCHOTT data sheets.
constexpr Catalogue kSchott[] = {
    {"N-BK7", 1.51680, 64.17},   {"F2", 1.62004, 36.37},      {"SF6", 1.80518, 25.43},    {"SF10", 1.72825, 28.41},
    {"SF11", 1.78472, 25.76},    {"N-SF5", 1.67271, 32.25},   {"N-SF10", 1.72828, 28.53}, {"N-SF11", 1.78472, 25.68},
    {"N-SF66", 1.92286, 20.88},  {"N-BAF10", 1.67003, 47.11}, {"N-K5", 1.52249, 59.48},   {"N-FK51A", 1.48656, 84.47},
    {"N-LAK22", 1.65113, 55.89}, {"N-LASF9", 1.85025, 32.17}, {"LAFN7", 1.74950, 34.95},
};

} // namespace

TEST_CASE("glasses have the index and Abbe number of the catalogue") {
    for (const Catalogue& c : kSchott) {
        CAPTURE(c.name);
        const auto glass = findGlass(c.name);
        REQUIRE(glass);
        const auto n = indexCurve(*glass);
        const double nd = n->at(587.5618), nF = n->at(486.1327), nC = n->at(656.2725);
        CHECK(std::abs(nd - c.nd) < 6e-6);
        CHECK(std::abs((nd - 1) / (nF - nC) - c.abbe) < 0.006);
        CHECK(usableIndex(*n));
        const auto absorption = absorptionCurve(*glass);
        CHECK(absorption->minimum() > 0);
        CHECK(absorption->at(550.0) < 5); // 1/m: a centimetre loses less than 5 %
    }
}

TEST_CASE("other transparent media have their handbook index at the sodium line") {
    const Catalogue expected[] = {{"water", 1.3334, 0},    {"diamond", 2.4175, 0},       {"fused silica", 0, 0},
                                  {"sapphire", 1.7682, 0}, {"NaCl", 1.5443, 0},          {"CaF2", 1.43385, 0},
                                  {"SiO2", 1.45846, 0},    {"rutile", 2.61427, 0},       {"acrylic", 1.4906, 0},
                                  {"PMMA", 1.4906, 0},     {"polycarbonate", 1.5850, 0}, {"polystyrene", 1.5916, 0},
                                  {"ethanol", 1.3617, 0},  {"glycerol", 1.4722, 0}};
    for (const Catalogue& c : expected) {
        CAPTURE(c.name);
        const auto glass = findGlass(c.name);
        CHECK(glass.has_value() == (c.nd != 0));
        if (!glass) continue;
        const auto n = indexCurve(*glass);
        CHECK(std::abs(n->at(587.5618) - c.nd) < 3e-4);
        CHECK(usableIndex(*n));
        CHECK(n->minimum() > 1);
    }
    CHECK(absorptionCurve(*findGlass("water"))->at(700.0) == doctest::Approx(4 * 3.14159265 * 3.35e-8 / 700e-9));
}

TEST_CASE("the index in eight lanes equals the index in double") {
    for (const auto name : glassNames()) {
        CAPTURE(name);
        const auto n = indexCurve(*findGlass(name));
        double worst = 0;
        for (int i = 0; i < 4000; ++i) {
            const Wavelengths w = Wavelengths::sample(static_cast<float>(i) / 4000);
            const Spectrum s = n->at(w);
            for (int lane = 0; lane < kLanes; ++lane)
                worst = std::max(worst, std::abs(s[lane] / n->at(static_cast<double>(w.nm[lane])) - 1));
        }
        CHECK(worst < 2e-7);
    }
}

TEST_CASE("curves agree with the plain formulas, and do not extrapolate") {
    for (const auto name : glassNames()) {
        CAPTURE(name);
        const auto glass = *findGlass(name);
        const auto n = indexCurve(glass);
        const Dispersion d{glass.formula, glass.coefficients, glass.minNm, glass.maxNm};
        for (double nm = 360; nm <= 830; nm += 10) CHECK(n->at(nm) == doctest::Approx(index(d, nm)).epsilon(1e-7));
    }
    const auto diamond = indexCurve(*findGlass("diamond")); // published up to 760 nm
    CHECK(diamond->at(800.0) == diamond->at(760.0));
    CHECK(diamond->at(Wavelengths::single(800))[0] == diamond->at(Wavelengths::single(760))[0]);
    const auto rutile = indexCurve(*findGlass("rutile")); // from 430 nm
    CHECK(rutile->at(380.0) == rutile->at(430.0));
}

TEST_CASE("the formulas of refractiveindex.info") {
    const double cauchy[] = {1.5046, 0.0042, -2};
    CHECK(index({DispersionFormula::cauchy, cauchy}, 500) == doctest::Approx(1.5046 + 0.0042 / 0.25));
    CHECK(makeIndexCurve({DispersionFormula::cauchy, cauchy})->at(500.0) == doctest::Approx(1.5046 + 0.0042 / 0.25));
    CHECK(CauchyCurve(1.5, 0.004, 1e-4).at(Wavelengths::single(400))[2] ==
          doctest::Approx(1.5 + 0.004 / 0.16 + 1e-4 / 0.0256));
    const double odd[] = {1.5, 0.01, -1, 0.001, -3};
    CHECK(makeIndexCurve({DispersionFormula::cauchy, odd})->at(500.0) == doctest::Approx(1.5 + 0.02 + 0.008));
    const double polynomial[] = {2.25, 0.01, -2};
    CHECK(index({DispersionFormula::polynomial, polynomial}, 500) == doctest::Approx(std::sqrt(2.29)));
}

TEST_CASE("unphysical indices are found out") {
    const double b[] = {1.0}, inside[] = {0.25}, outside[] = {0.01};
    CHECK_FALSE(usableIndex(SellmeierCurve(0, b, inside)));
    CHECK(usableIndex(SellmeierCurve(0, b, outside)));
    const double weak[] = {1e-12};
    const double between[] = {0.5000005 * 0.5000005}; // too narrow for any table
    CHECK_FALSE(usableIndex(SellmeierCurve(1, weak, between)));
    CHECK_FALSE(usableIndex(CauchyCurve(0.1, 0)));
    CHECK_FALSE(usableIndex(CauchyCurve(12, 0)));
    CHECK_FALSE(usableIndex(CauchyCurve(std::nan(""), 0)));
    CHECK_FALSE(usableIndex(SellmeierCurve(-3, {}, {})));
}

TEST_CASE("metals have their published constants") {
    const auto check = [](const char* name, double nm, double n, double k) {
        CAPTURE(name);
        const auto metal = findMetal(name);
        REQUIRE(metal);
        CHECK(indexCurve(*metal)->at(nm) == doctest::Approx(n).epsilon(1e-6));
        CHECK(extinctionCurve(*metal)->at(nm) == doctest::Approx(k).epsilon(1e-6));
    };
    // [Johnson1972] at 2.26, 1.88 and 2.5 eV, interpolated within the node's nanometre.
    const auto near = [](const char* name, double nm, double n, double k) {
        CAPTURE(name);
        CHECK(std::abs(indexCurve(*findMetal(name))->at(nm) - n) < 0.01);
        CHECK(std::abs(extinctionCurve(*findMetal(name))->at(nm) - k) < 0.02);
    };
    near("Au", 548.6, 0.43, 2.455);
    near("gold", 659.5, 0.14, 3.697);
    near("Ag", 548.6, 0.06, 3.586);
    near("Cu", 659.5, 0.22, 3.747);
    near("Cr", 549, 3.18, 3.33);
    near("Fe", 549, 2.95, 2.93);
    near("Pd", 549, 1.64, 3.84);
    near("cobalt", 549, 2.05, 3.82);
    check("brass", 550, 0.527, 2.765);
    check("red-brass", 550, 0.519, 2.415);
    check("steel", 600, 2.0565, 3.3248);
    near("zinc", 551.041, 0.9322, 4.985);
    check("purple-gold", 540, 1.275, 1.407);
    near("TiN", 495.9, 1.2, 1.65);
    check("Si", 550, 4.077, 0.027968);
    CHECK(metalNames().size() >= 20);
    for (const auto name : metalNames()) {
        CAPTURE(name);
        const auto metal = findMetal(name);
        CHECK(metal->nm.front() <= 360);
        CHECK(metal->nm.back() >= 830);
        CHECK(indexCurve(*metal)->minimum() > 0);
        CHECK(extinctionCurve(*metal)->minimum() >= 0);
    }
}

TEST_CASE("names: any case, aliases, nothing for the unknown") {
    CHECK(findGlass("bk7")->name == "N-BK7");
    CHECK(findGlass("SF10")->name == "SF10");
    CHECK(findGlass("n-sf10")->name == "N-SF10");
    CHECK(findGlass("SF5")->name == "N-SF5");
    CHECK(findMeasured("dark-skin")->name == "macbeth-1");
    CHECK(findMeasured("Blue")->name == "macbeth-13");
    CHECK(findIlluminant("fl3.15")->name == "FL3.15");
    CHECK_FALSE(findGlass(""));
    CHECK_FALSE(findGlass("N-"));
    CHECK_FALSE(findIlluminant("D66"));
    CHECK_FALSE(findMetal("unobtainium"));
    CHECK_FALSE(findMeasured("macbeth-25"));
    for (const auto name : measuredNames()) {
        CAPTURE(name);
        const auto r = reflectanceCurve(*findMeasured(name));
        CHECK(r->minimum() > 0);
        CHECK(r->maximum() < 1);
        CHECK_FALSE(findMeasured(name)->source.empty());
    }
}

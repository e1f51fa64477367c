// Interference in thin films against complex arithmetic in long double and against its limits (case 44).
#include "materials/thin_film.h"
#include "support/ggx_reference.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe {
namespace {

// Written as characteristic matrices [Born1999, §1.6], not as the sum over reflections.
double referenceFilm(double cosI, double n1, double nf, double n3, double k3, double turns) {
    using Complex = std::complex<long double>;
    const Complex one(1), i(0, 1);
    const long double s2 = static_cast<long double>(n1 * n1 * (1 - cosI * cosI));
    const auto q = [&](Complex n) {
        Complex r = std::sqrt(n * n - s2);
        return r.imag() < 0 ? -r : r;
    };
    const Complex e1(n1 * n1), ef(nf * nf), e3 = Complex(n3, k3) * Complex(n3, k3);
    const Complex q1 = q(Complex(n1)), qf = q(Complex(nf)), q3 = q(Complex(n3, k3));
    const Complex delta = 2 * std::numbers::pi_v<long double> * qf * static_cast<long double>(turns);
    double sum = 0;
    for (const bool p : {false, true}) {
        const Complex a1 = p ? q1 / e1 : q1, af = p ? qf / ef : qf, a3 = p ? q3 / e3 : q3; // admittances
        const Complex b = std::cos(delta) - i * std::sin(delta) * a3 / af;
        const Complex c = a3 * std::cos(delta) - i * std::sin(delta) * af;
        sum += static_cast<double>(std::norm((a1 * b - c) / (a1 * b + c)));
    }
    return sum / 2;
}

ThinFilm film(double outer, double index, double n, double k, double nm, double wavelength = 550) {
    const auto s = [](double x) { return Spectrum(static_cast<float>(x)); };
    return {s(outer), s(index), s(n), s(k), s(wavelength), static_cast<float>(nm)};
}
double reflectance(double cosI, const ThinFilm& f) {
    return static_cast<double>(thinFilmReflectance(Spectrum(static_cast<float>(cosI)), f)[0]);
}

TEST_CASE("films over glass and metal agree with characteristic matrices") {
    test::Random random(1);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto between = [&](double a, double b) {
            return static_cast<double>(static_cast<float>(a + (b - a) * random.uniformDouble()));
        };
        const double c = between(0.001, 1), n1 = between(1, 1.8), nf = between(1, 2.5), n3 = between(0.1, 2.5);
        const double k = i % 2 ? between(0, 6) : 0, d = between(0, 2000), lambda = between(360, 830);
        const double expected = referenceFilm(c, n1, nf, n3, k, d / lambda);
        worst = std::max(worst, std::abs(reflectance(c, film(n1, nf, n3, k, d, lambda)) - expected));
    }
    MESSAGE("largest error ", worst);
    CHECK(worst < 2e-4); // at the critical angles, where the root's slope is infinite
}

TEST_CASE("a film of no thickness, or of its neighbour's index, is no film") {
    for (const double k : {0.0, 0.001, 3.0})
        for (const double c : {0.0, 0.01, 0.2, 0.5, 0.8, 1.0}) {
            const double cf = static_cast<double>(static_cast<float>(c)),
                         nk = static_cast<double>(static_cast<float>(k));
            const double bare = k == 0 ? test::referenceFresnel(cf, 1.5) : test::referenceFresnel(cf, 1.5, nk);
            CHECK(std::abs(reflectance(c, film(1, 1.33, 1.5, k, 0)) - bare) < 1e-6);
            CHECK(std::abs(reflectance(c, film(1, 1, 1.5, k, 700)) - bare) < 1e-6);
            if (k == 0) CHECK(std::abs(reflectance(c, film(1, 1.5, 1.5, k, 700)) - bare) < 1e-6);
            CHECK(std::abs(reflectance(c, film(1, 1.33, 1.5, k, 0.01)) - bare) < 2e-3); // continuous
        }
}

TEST_CASE("a quarter-wave coating of √n takes the reflection away") {
    CHECK(reflectance(1, film(1, std::sqrt(1.5), 1.5, 0, 550 / (4 * std::sqrt(1.5)))) < 1e-6);
}

TEST_CASE("total reflection inside the film: a thin one lets light tunnel, a thick one does not") {
    // From n = 1.6 at 70 degrees the film of n = 1.3 reflects totally.
    const double c = std::cos(70 * kPiD / 180);
    CHECK(reflectance(c, film(1.6, 1.3, 1.6, 0, 20)) < 0.1);
    CHECK(reflectance(c, film(1.6, 1.3, 1.6, 0, 3000)) > 0.999);
    CHECK(reflectance(c, film(1.6, 1.3, 1.6, 0, 1e9)) == doctest::Approx(1));
}

TEST_CASE("thick films show the sum of intensities, thin ones fringes around it") {
    const double f12 = test::referenceFresnel(1, 1.4), f23 = test::referenceFresnel(1, 1.7 / 1.4);
    const double incoherent = f12 + (1 - f12) * (1 - f12) * f23 / (1 - f12 * f23);
    for (const double nm : {1e4, 1e6, 1e9, 1e12})
        CHECK(reflectance(1, film(1, 1.4, 1.7, 0, nm)) == doctest::Approx(incoherent).epsilon(1e-5));
    test::Moments fringes;
    for (int i = 0; i < 4000; ++i) fringes.add(reflectance(1, film(1, 1.4, 1.7, 0, 3000 + 0.5 * i)));
    CHECK(fringes.mean() == doctest::Approx(incoherent).epsilon(5e-3));
}

TEST_CASE("films are finite and between 0 and 1 at the edges of everything") {
    bool good = true;
    for (const double c : {0.0, 1e-30, 1e-6, 0.5, 1.0})
        for (const double n1 : {0.2, 1.0, 3.0})
            for (const double nf : {0.2, 1.0, 3.0})
                for (const double n3 : {0.0, 0.2, 1.0, 3.0})
                    for (const double k : {0.0, 1e-6, 10.0, 1e6})
                        for (const double nm : {0.0, 1e-6, 100.0, 7000.0, 1e9}) {
                            const double r = reflectance(c, film(n1, nf, n3, k, nm));
                            good = good && r >= 0 && r <= 1;
                        }
    CHECK(good);
}

} // namespace
} // namespace abbe

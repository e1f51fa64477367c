// Fresnel's formulas and films: cases 28, 29 and 44 of docs/hard_cases.md.
#include "hard_cases/hard_case.h"
#include "materials/thin_film.h"
#include "support/ggx_reference.h"
#include "support/statistics.h"

#include <complex>

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 28: Fresnel near the critical angle or with η near 1") {
    HardCase c;
    c.doctor();
    double worst = 0; // the textbook's formulas in single precision
    for (const double delta : {1e-6, 1e-5, 1e-4, 1e-3}) {
        const float eta = static_cast<float>(1 / (1 + delta));
        const double critical = std::sqrt(1 - static_cast<double>(eta) * static_cast<double>(eta));
        for (int i = 0; i <= 5000; ++i) {
            const float cosI = static_cast<float>(critical * i / 2500), sinT = std::sqrt(1 - cosI * cosI) / eta;
            float r = 1;
            if (sinT < 1) {
                const float cosT = std::sqrt(1 - sinT * sinT);
                const float rs = (cosI - eta * cosT) / (cosI + eta * cosT),
                            rp = (eta * cosI - cosT) / (eta * cosI + cosT);
                r = (rs * rs + rp * rp) / 2;
            }
            worst = std::max(worst, std::abs(static_cast<double>(r) -
                                             referenceFresnel(static_cast<double>(cosI), static_cast<double>(eta))));
        }
    }
    c.naive("the textbook's formulas in single precision", worst);
}

TEST_CASE("case 29: conductors with k near 0 or huge") {
    HardCase c;
    c.doctor();
    Random random(5);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const float n = std::pow(10.f, -2 + 3 * random.uniform()), k = std::pow(10.f, -8 + 13 * random.uniform());
        const float cosI = random.uniform(), s2 = 1 - cosI * cosI;
        // a² + b² and a from it, as usually written.
        const float t0 = n * n - k * k - s2, ab = std::sqrt(t0 * t0 + 4 * n * n * k * k),
                    a = std::sqrt(0.5f * (ab + t0));
        const float rs = (ab + cosI * cosI - 2 * a * cosI) / (ab + cosI * cosI + 2 * a * cosI);
        const float t3 = cosI * cosI * ab + s2 * s2, t4 = 2 * a * cosI * s2;
        const double r = static_cast<double>(0.5f * (rs + rs * (t3 - t4) / (t3 + t4)));
        const double off =
            std::abs(r - referenceFresnel(static_cast<double>(cosI), static_cast<double>(n), static_cast<double>(k)));
        worst = off <= worst ? worst : off;
    }
    c.naive("a² from a² + b² in single precision", worst);
}

TEST_CASE("case 44: thin films of no thickness, of huge thickness, with total reflection inside") {
    HardCase c;
    c.doctor();
    c.naive("phase of a film of 1e9 nm in single precision, against its own remainder", [] {
        // A thousandth of a turn is 0.6 % of the fringes; floats of 5e6 turns are half a turn apart.
        const float turns = 2.f * 1.4f * 1e9f / 550.f;
        const double exact = 2 * static_cast<double>(1.4f) * 1e9 / 550;
        return std::abs(static_cast<double>(turns) - exact);
    }());
    int bad = 0;
    const auto s = [](double x) { return Spectrum(static_cast<float>(x)); };
    for (const double cosine : {0.0, 1e-30, 1e-6, 0.5, 1.0})
        for (const double n1 : {0.2, 1.0, 3.0})
            for (const double nf : {0.2, 1.0, 3.0})
                for (const double n3 : {0.0, 0.2, 1.0, 3.0})
                    for (const double k : {0.0, 1e-6, 10.0, 1e6})
                        for (const double nm : {0.0, 1e-6, 100.0, 7000.0, 1e9}) {
                            const ThinFilm f{s(n1), s(nf), s(n3), s(k), s(550), static_cast<float>(nm)};
                            const float r = thinFilmReflectance(s(cosine), f)[0];
                            bad += !(r >= 0 && r <= 1);
                        }
    c.measured("of 3600 films, reflectances outside of 0 … 1", bad, 0);
    const volatile float under = 1.f * 1.f - 1.6f * 1.6f * 0.88f; // n² - n₁² sin²θ₁ beyond the critical angle
    c.naive("real root of total reflection", static_cast<double>(std::sqrt(under)));
}

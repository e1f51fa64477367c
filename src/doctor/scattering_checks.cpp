#include "doctor/numeric_check.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/thin_film.h"
#include "math/frame.h"
#include "math/hash.h"

#include <complex>

namespace abbe::doctor {

namespace {

double wide(float x) { return static_cast<double>(x); }

// [Born1999, §1.5] with cos θt from Snell's law.
double dielectricInDouble(double cosI, double eta) {
    const double sine = std::sqrt(std::max(0.0, 1 - cosI * cosI)) / eta;
    if (sine >= 1) return 1;
    const double cosT = std::sqrt(1 - sine * sine);
    const double rs = (cosI - eta * cosT) / (cosI + eta * cosT), rp = (eta * cosI - cosT) / (eta * cosI + cosT);
    return (rs * rs + rp * rp) / 2;
}

// By complex arithmetic.
double conductorInLongDouble(double cosI, double n, double k) {
    using Complex = std::complex<long double>;
    const Complex index(n, k), one(1), cosine(cosI);
    const Complex g = std::sqrt(index * index - (one - cosine * cosine));
    const Complex rs = (cosine - g) / (cosine + g), rp = (index * index * cosine - g) / (index * index * cosine + g);
    return static_cast<double>((std::norm(rs) + std::norm(rp)) / 2);
}

double dielectricError(double leastContrast) {
    double worst = 0;
    for (const double delta : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.33, 0.5, 1.4})
        for (const bool denser : {false, true}) {
            const float eta = static_cast<float>(denser ? 1 + delta : 1 / (1 + delta));
            if (std::abs(wide(eta) - 1) < leastContrast) continue;
            const double critical = eta < 1 ? std::sqrt(1 - wide(eta) * wide(eta)) : 0.1;
            for (int i = 0; i <= 20000; ++i) {
                const float c = static_cast<float>(std::min(1.0, i <= 10000 ? i / 10000.0 : critical * i / 15000.0));
                const double expected = dielectricInDouble(wide(c), wide(eta));
                worst = std::max(worst, std::abs(wide(fresnelDielectric(c, eta)) - expected));
            }
        }
    return worst;
}

double reflectance(float cosine, float film, float n, float k, float nm) {
    const ThinFilm f{Spectrum(1.f), Spectrum(film), Spectrum(n), Spectrum(k), Spectrum(550.f), nm};
    return wide(thinFilmReflectance(Spectrum(cosine), f)[0]);
}

} // namespace

double fresnelDielectricError() { return dielectricError(0); }
double fresnelDielectricErrorApart() { return dielectricError(0.009); }

double fresnelConductorError() {
    RandomStream random(5);
    double worst = 0;
    for (int i = 0; i < 200000; ++i) {
        const float n = std::pow(10.f, -2 + 3 * random.uniform()), k = std::pow(10.f, -8 + 13 * random.uniform());
        const float c = i % 7 ? random.uniform() : i % 2 ? 0.f : 1.f;
        const double got = wide(fresnelConductor(c, Spectrum(n), Spectrum(k))[5]);
        worst = std::max(worst, std::abs(got - conductorInLongDouble(wide(c), wide(n), wide(k))));
    }
    return worst;
}

double ggxDensityError() {
    RandomStream random(1);
    double worst = 0;
    for (const float alpha : {1e-4f, 3e-4f, 1e-3f, 1e-2f, 0.1f, 0.5f, 1.f})
        for (int i = 0; i < 20000; ++i) {
            const float slope = alpha * 5 * random.uniform(), phi = 2 * kPi * random.uniform();
            const Vec3 m = normalize(Vec3{slope * std::cos(phi), slope * std::sin(phi), 1});
            const float alphaY = i % 2 ? alpha : std::min(1.f, 3 * alpha);
            const Vec3d w(m);
            const double s = square(w.x / wide(alpha)) + square(w.y / wide(alphaY)) + w.z * w.z;
            const double expected = 1 / (kPiD * wide(alpha) * wide(alphaY) * s * s);
            worst = std::max(worst, std::abs(wide(Ggx(alpha, alphaY).D(m)) / expected - 1));
        }
    return worst;
}

double emptyFilmError() {
    double worst = 0;
    for (const float k : {0.f, 0.001f, 3.f})
        for (int i = 0; i <= 100; ++i) {
            const float c = static_cast<float>(i) / 100;
            const double bare =
                k == 0 ? dielectricInDouble(wide(c), 1.5) : conductorInLongDouble(wide(c), 1.5, wide(k));
            worst = std::max(worst, std::abs(reflectance(c, 1.33f, 1.5f, k, 0) - bare));
        }
    return worst;
}

double frameError() {
    constexpr float values[] = {0.f,    -0.f,  1e-38f, -1e-38f, 1e-20f, -1e-20f, 1e-7f, -1e-7f, 1e-5f,
                                -1e-5f, 1e-4f, -1e-4f, 1e-2f,   -1e-2f, 0.5f,    -0.5f, 1.f,    -1.f};
    float worst = 0;
    for (const float x : values)
        for (const float y : values)
            for (const float z : values) {
                const Vec3d raw(x, y, z);
                if (!(length(raw) > 1e-30)) continue;
                const Frame f = Frame::fromNormal(Vec3(normalize(raw)));
                for (const float e : {dot(f.x, f.y), dot(f.x, f.z), dot(f.y, f.z)})
                    worst = std::abs(e) <= worst ? worst : std::abs(e); // not a number wins
            }
    return wide(worst);
}

} // namespace abbe::doctor

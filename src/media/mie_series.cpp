#include "media/mie_series.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

using Complex = std::complex<double>;

// ψ_n'(z)/ψ_n(z) for n up to `orders`, by the recurrence that is stable downwards [BohrenHuffman1983, eq. 4.89]. It
// forgets its arbitrary start only while n is above |z|, within a few |z|^⅓: the fifteen orders of the book are too few
// for large spheres.
std::vector<Complex> logarithmicDerivative(Complex z, std::size_t orders) {
    const double size = std::abs(z);
    const std::size_t start = std::max(orders, static_cast<std::size_t>(size + 8 * std::cbrt(size))) + 16;
    std::vector<Complex> d(start + 1);
    for (std::size_t n = start; n > 0; --n) {
        const Complex ratio = static_cast<double>(n) / z;
        d[n - 1] = ratio - 1.0 / (d[n] + ratio);
    }
    d.resize(orders + 1);
    return d;
}

// The sums over a and b [BohrenHuffman1983, eqs. 4.61, 4.62 and p. 120].
void sumUp(MieSeries& series, double size) {
    double extinction = 0, scattering = 0, asymmetry = 0;
    for (std::size_t i = 0; i < series.a.size(); ++i) {
        const Complex a = series.a[i], b = series.b[i];
        const auto n = static_cast<double>(i + 1);
        extinction += (2 * n + 1) * (a.real() + b.real());
        scattering += (2 * n + 1) * (std::norm(a) + std::norm(b));
        asymmetry += (2 * n + 1) / (n * (n + 1)) * (a * std::conj(b)).real();
        if (i + 1 < series.a.size())
            asymmetry +=
                n * (n + 2) / (n + 1) * (a * std::conj(series.a[i + 1]) + b * std::conj(series.b[i + 1])).real();
    }
    series.extinction = 2 * extinction / (size * size);
    series.scattering = 2 * scattering / (size * size);
    series.asymmetry = scattering > 0 ? 2 * asymmetry / scattering : 0;
}

} // namespace

// [Wiscombe1980, eq. 22]
std::size_t mieOrders(double size) { return static_cast<std::size_t>(size + 4 * std::cbrt(size) + 2); }

// [BohrenHuffman1983, eq. 4.88]: ψ and ξ = ψ - i χ of the outside by recurrence upwards.
MieSeries mieSeries(double size, Complex index) {
    ABBE_CHECK(size > 0 && index.real() > 0);
    const std::size_t orders = mieOrders(size);
    const std::vector<Complex> d = logarithmicDerivative(index * size, orders);
    MieSeries series;
    series.a.reserve(orders);
    series.b.reserve(orders);
    double psiBefore = std::cos(size), psi = std::sin(size), chiBefore = -psi, chi = psiBefore;
    for (std::size_t i = 1; i <= orders; ++i) {
        const auto n = static_cast<double>(i);
        const double nextPsi = (2 * n - 1) / size * psi - psiBefore, nextChi = (2 * n - 1) / size * chi - chiBefore;
        psiBefore = psi, psi = nextPsi;
        chiBefore = chi, chi = nextChi;
        const Complex xi{psi, -chi}, xiBefore{psiBefore, -chiBefore};
        const Complex electric = d[i] / index + n / size, magnetic = d[i] * index + n / size;
        series.a.push_back((electric * psi - psiBefore) / (electric * xi - xiBefore));
        series.b.push_back((magnetic * psi - psiBefore) / (magnetic * xi - xiBefore));
    }
    sumUp(series, size);
    return series;
}

} // namespace abbe

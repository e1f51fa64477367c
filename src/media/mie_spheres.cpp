#include "media/mie_spheres.h"

#include "base/check.h"
#include "math/vec.h"

#include <algorithm>
#include <cmath>
#include <immintrin.h>

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

namespace {

// x with Φ(x) = p, by bisection: this is called a few hundred times.
double normalQuantile(double p) {
    double low = -9, high = 9;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(-middle / std::sqrt(2.0)) < p ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

// Of one sphere, ready to be summed: (2n + 1)/(n (n + 1)) times a + b and a - b.
struct Orders {
    std::vector<double> rows; // four numbers for each order: both sums, real and imaginary
    double weight;            // of |S|², for equal shares of cross-section
};

Orders ordersOf(const MieSeries& series, double size) {
    Orders orders;
    orders.weight = 0.25 / (kPiD * size * size);
    for (std::size_t i = 0; i < series.a.size(); ++i) {
        const auto n = static_cast<double>(i + 1);
        const double f = (2 * n + 1) / (n * (n + 1));
        const std::complex<double> sum = f * (series.a[i] + series.b[i]), difference = f * (series.a[i] - series.b[i]);
        orders.rows.insert(orders.rows.end(), {sum.real(), sum.imag(), difference.real(), difference.imag()});
    }
    return orders;
}

using Double4 = double __attribute__((vector_size(32)));
Double4 all(double x) { return Double4{x, x, x, x}; }
Double4 fma(Double4 a, Double4 b, Double4 c) { return _mm256_fmadd_pd(a, b, c); }

// Eight angles at once.
struct Angles8 {
    Double4 first, second;
};

// π_n + τ_n and π_n - τ_n of eight angles for all orders: S1 ± S2 are sums of (a ± b) times these
// [BohrenHuffman1983, eqs. 4.47 and 4.74].
std::vector<Angles8> angularFunctions(const double* angles, std::size_t orders) {
    std::vector<Angles8> rows(2 * orders);
    for (int half = 0; half < 2; ++half) {
        Double4 mu{};
        for (int lane = 0; lane < 4; ++lane) mu[lane] = std::cos(angles[4 * half + lane]);
        Double4 before{}, pi = all(1);
        for (std::size_t i = 1; i <= orders; ++i) {
            const auto n = static_cast<double>(i);
            const Double4 tau = n * mu * pi - (n + 1) * before;
            (half == 0 ? rows[2 * i - 2].first : rows[2 * i - 2].second) = pi + tau;
            (half == 0 ? rows[2 * i - 1].first : rows[2 * i - 1].second) = pi - tau;
            const Double4 next = ((2 * n + 1) / n) * mu * pi - ((n + 1) / n) * before;
            before = pi;
            pi = next;
        }
    }
    return rows;
}

// Adds the intensity of one sphere at eight angles: |S1|² + |S2|² = (|S1 + S2|² + |S1 - S2|²)/2. The inner loop of all
// of this.
void add(const Orders& sphere, const Angles8* functions, Angles8& intensity) {
    Angles8 plusReal{}, plusImag{}, minusReal{}, minusImag{};
    const auto accumulate = [](Angles8& sum, double coefficient, const Angles8& f) {
        const Double4 c = all(coefficient);
        sum.first = fma(c, f.first, sum.first);
        sum.second = fma(c, f.second, sum.second);
    };
    const double* row = sphere.rows.data();
    const double* const end = row + sphere.rows.size();
    for (; row != end; row += 4, functions += 2) {
        accumulate(plusReal, row[0], functions[0]);
        accumulate(plusImag, row[1], functions[0]);
        accumulate(minusReal, row[2], functions[1]);
        accumulate(minusImag, row[3], functions[1]);
    }
    const auto square4 = [](Double4 a, Double4 b, Double4 c, Double4 d) { return a * a + b * b + c * c + d * d; };
    const Double4 w = all(sphere.weight);
    intensity.first += w * square4(plusReal.first, plusImag.first, minusReal.first, minusImag.first);
    intensity.second += w * square4(plusReal.second, plusImag.second, minusReal.second, minusImag.second);
}

} // namespace

// A lognormal of mean `radius` and standard deviation `spread` times that, in shares of equal probability.
std::vector<double> DropSizes::radii(std::size_t count) const {
    if (!(spread > 0)) return {radius};
    const double variance = std::log1p(spread * spread);
    std::vector<double> result(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double p = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        result[i] = radius * std::exp(std::sqrt(variance) * normalQuantile(p) - variance / 2);
    }
    return result;
}

MieScattering mieScattering(std::span<const double> radii, double wavelength, std::complex<double> index,
                            std::span<const double> angles) {
    ABBE_CHECK(!radii.empty());
    MieScattering result;
    const double share = 1 / static_cast<double>(radii.size());
    std::vector<Orders> spheres;
    std::size_t largest = 0;
    for (const double radius : radii) {
        const double size = 2 * kPiD * radius / wavelength;
        const MieSeries series = mieSeries(size, index);
        result.extinction += share * series.extinction;
        result.scattering += share * series.scattering;
        result.asymmetry += share * series.scattering * series.asymmetry;
        spheres.push_back(ordersOf(series, size));
        spheres.back().weight *= share;
        largest = std::max(largest, series.a.size());
    }
    if (result.scattering > 0) result.asymmetry /= result.scattering;
    result.intensity.resize(angles.size());
    for (std::size_t from = 0; from < angles.size(); from += 8) {
        double block[8];
        for (std::size_t i = 0; i < 8; ++i) block[i] = angles[std::min(from + i, angles.size() - 1)];
        const std::vector<Angles8> functions = angularFunctions(block, largest);
        Angles8 sum{};
        for (const Orders& sphere : spheres) add(sphere, functions.data(), sum);
        for (std::size_t i = 0; i < 8 && from + i < angles.size(); ++i)
            result.intensity[from + i] = i < 4 ? sum.first[i] : sum.second[i - 4];
    }
    return result;
}

} // namespace abbe

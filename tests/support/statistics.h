// Distributions and summaries for statistical tests. Double precision; every p-value is the probability, under the
// hypothesis, of a deviation at least as large as the one seen.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace abbe::test {

// Uniform numbers in [0, 1) for tests: the same stream on every machine [ONeill2014].
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ull + 1) { bits(); }
    std::uint32_t bits() {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005ull + 1442695040888963407ull;
        const auto shifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
        const auto turn = static_cast<std::uint32_t>(old >> 59);
        return (shifted >> turn) | (shifted << ((32 - turn) & 31));
    }
    float uniform() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
    double uniformDouble() { return (static_cast<double>(bits()) + 0.5) * 0x1p-32; }

  private:
    std::uint64_t state_;
};

// P(a, x) = γ(a, x)/Γ(a), the regularised lower incomplete gamma function; a > 0, x >= 0. Series below a + 1,
// Lentz's continued fraction above [Press2007, §6.2].
inline double regularisedGammaP(double a, double x) {
    if (!(x > 0)) return 0;
    const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; std::abs(term) > 1e-16 * std::abs(sum); ++n) sum += term *= x / n;
        return sum * scale;
    }
    constexpr double tiny = 1e-300;
    double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
    for (int i = 1; i < 100000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = an * d + b;
        d = 1 / (std::abs(d) < tiny ? tiny : d);
        c = b + an / c;
        c = std::abs(c) < tiny ? tiny : c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return 1 - scale * h;
}
inline double regularisedGammaQ(double a, double x) { return 1 - regularisedGammaP(a, x); }

// I_x(a, b), the regularised incomplete beta function; x in [0, 1] [Press2007, §6.4].
inline double regularisedBeta(double a, double b, double x) {
    if (x <= 0) return 0;
    if (x >= 1) return 1;
    if (x > (a + 1) / (a + b + 2)) return 1 - regularisedBeta(b, a, 1 - x);
    constexpr double tiny = 1e-300;
    const auto guard = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1, d = 1 / guard(1 - (a + b) * x / (a + 1)), h = d;
    for (int m = 1; m < 10000; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / guard(1 + even * d);
        c = guard(1 + even / c);
        h *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / guard(1 + odd * d);
        c = guard(1 + odd / c);
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    return front * h / a;
}

// Two-sided p-value of a standard normal deviate.
inline double normalTwoSided(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }
// P(χ² with `degrees` degrees of freedom >= statistic).
inline double chiSquareUpper(double statistic, double degrees) { return regularisedGammaQ(degrees / 2, statistic / 2); }
// Two-sided p-value of Student's t.
inline double studentTwoSided(double t, double degrees) {
    return regularisedBeta(degrees / 2, 0.5, degrees / (degrees + t * t));
}
// P(√n·D >= x) of Kolmogorov's statistic D in the limit of many samples.
inline double kolmogorovUpper(double x) {
    if (x < 0.2) return 1;
    double sum = 0;
    for (int k = 1; k <= 100; ++k) sum += (k % 2 ? 2 : -2) * std::exp(-2.0 * k * k * x * x);
    return std::clamp(sum, 0.0, 1.0);
}
// p-value that `values` are uniform on [0, 1] (apply the distribution function first). Stephens' correction for the
// number of samples.
inline double kolmogorovUniform(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const double n = static_cast<double>(values.size());
    double d = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        d = std::max({d, static_cast<double>(i + 1) / n - values[i], values[i] - static_cast<double>(i) / n});
    const double root = std::sqrt(n);
    return kolmogorovUpper(d * (root + 0.12 + 0.11 / root));
}

// Level for each of `tests` tests so that all of them together err with probability `level`.
inline double bonferroni(double level, int tests) { return level / tests; }
inline double sidak(double level, int tests) { return -std::expm1(std::log1p(-level) / tests); }

// Running mean and variance [Welford1962].
class Moments {
  public:
    void add(double x) {
        const double delta = x - mean_;
        mean_ += delta / ++n_;
        m2_ += delta * (x - mean_);
    }
    double count() const { return n_; }
    double mean() const { return mean_; }
    double variance() const { return n_ > 1 ? m2_ / (n_ - 1) : std::numeric_limits<double>::infinity(); }
    double standardError() const { return std::sqrt(variance() / n_); }

  private:
    double n_ = 0, mean_ = 0, m2_ = 0;
};

// Two-sided p-value that the mean of the samples is `expected` (Student's t). Samples without spread must equal it to
// 1e-6 relative.
inline double meanTest(const Moments& m, double expected) {
    const double error = std::abs(m.mean() - expected);
    if (error <= 1e-6 * std::abs(expected)) return 1;
    return m.variance() > 0 ? studentTwoSided(error / m.standardError(), m.count() - 1) : 0;
}
// Two-sided p-value that two sets of samples have the same mean (Welch's t).
inline double sameMeanTest(const Moments& a, const Moments& b) {
    const double va = a.variance() / a.count(), vb = b.variance() / b.count();
    if (va + vb == 0) return a.mean() == b.mean() ? 1 : 0;
    const double degrees = (va + vb) * (va + vb) / (va * va / (a.count() - 1) + vb * vb / (b.count() - 1));
    return studentTwoSided((a.mean() - b.mean()) / std::sqrt(va + vb), degrees);
}

} // namespace abbe::test

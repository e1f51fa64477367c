// Real roots of polynomials of low degree.
#pragma once

#include <array>
#include <cmath>
#include <utility>

namespace abbe {

// Coefficients from the constant on.
template <int N> using Polynomial = std::array<double, N + 1>;

template <int N> double evaluate(const Polynomial<N>& c, double x) {
    double sum = c[N];
    for (int i = N - 1; i >= 0; --i) sum = std::fma(sum, x, c[static_cast<std::size_t>(i)]);
    return sum;
}

template <int N> Polynomial<N - 1> derivative(const Polynomial<N>& c) {
    Polynomial<N - 1> d{};
    for (int i = 1; i <= N; ++i) d[static_cast<std::size_t>(i - 1)] = i * c[static_cast<std::size_t>(i)];
    return d;
}

template <int N> struct PolynomialRoots {
    std::array<double, N> x{};
    int count = 0;
    void add(double root) { x[static_cast<std::size_t>(count++)] = root; }
};

// The root in [lower, upper], where c changes its sign once: Newton's method, and bisection where it would leave the
// bracket or does not halve it.
template <int N> double bracketedRoot(const Polynomial<N>& c, double lower, double upper) {
    const Polynomial<N - 1> slope = derivative<N>(c);
    const bool rising = evaluate<N>(c, upper) > 0;
    double x = 0.5 * (lower + upper), before = upper - lower, step = before;
    for (int i = 0; i < 100; ++i) {
        const double f = evaluate<N>(c, x), g = evaluate<N - 1>(slope, x);
        if (f == 0) return x;
        ((f > 0) == rising ? upper : lower) = x;
        const double newton = x - f / g;
        const bool good = newton > lower && newton < upper && std::abs(2 * f) <= std::abs(before * g);
        before = step;
        const double next = good ? newton : 0.5 * (lower + upper);
        step = next - x;
        if (next == x || std::abs(step) <= 0x1p-52 * std::abs(x)) return next;
        x = next;
    }
    return x;
}

// Roots in [lower, upper], ascending; a root where the sign does not change may be left out. Between neighbouring roots
// of the derivative there is at most one root, which a bracket holds and cannot lose [Yuksel2022].
template <int N> PolynomialRoots<N> rootsWithin(const Polynomial<N>& c, double lower, double upper) {
    PolynomialRoots<N> roots;
    if constexpr (N == 2) {
        const double b = 0.5 * c[1], discriminant = std::fma(b, b, -c[2] * c[0]);
        if (!(discriminant >= 0)) return roots;
        const double q = -(b + std::copysign(std::sqrt(discriminant), b));
        double first = q / c[2], second = q != 0 ? c[0] / q : first;
        if (first > second) std::swap(first, second);
        if (first >= lower && first <= upper) roots.add(first);
        if (second >= lower && second <= upper && second != first) roots.add(second);
    } else {
        const PolynomialRoots<N - 1> turns = rootsWithin<N - 1>(derivative<N>(c), lower, upper);
        double from = lower;
        bool below = evaluate<N>(c, from) < 0;
        for (int i = 0; i <= turns.count; ++i) {
            const double to = i < turns.count ? turns.x[static_cast<std::size_t>(i)] : upper;
            const bool belowNext = evaluate<N>(c, to) < 0;
            if (below != belowNext) roots.add(bracketedRoot<N>(c, from, to));
            from = to;
            below = belowNext;
        }
    }
    return roots;
}

} // namespace abbe

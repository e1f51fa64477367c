// Deterministic integration for tests.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace abbe::test {

// Nodes and weights of N-point Gauss-Legendre quadrature on [0, 1].
template <int N> struct GaussLegendre {
    std::array<double, N> node, weight;

    GaussLegendre() {
        for (int i = 0; i < N; ++i) {
            double x = std::cos(3.14159265358979323846 * (i + 0.75) / (N + 0.5)), derivative = 0;
            for (int step = 0; step < 100; ++step) { // Newton on the Legendre polynomial of degree N
                double p = 1, previous = 0;
                for (int k = 0; k < N; ++k) {
                    const double next = ((2 * k + 1) * x * p - k * previous) / (k + 1);
                    previous = p;
                    p = next;
                }
                derivative = N * (x * p - previous) / (x * x - 1);
                const double delta = p / derivative;
                x -= delta;
                if (std::abs(delta) < 1e-15) break;
            }
            node[static_cast<std::size_t>(i)] = 0.5 * (1 - x);
            weight[static_cast<std::size_t>(i)] = 1 / ((1 - x * x) * derivative * derivative);
        }
    }
};

// ∫ f over [a, b], composite: `cells` equal cells of an eight-point rule.
template <typename F> double integrate(F&& f, double a, double b, int cells = 64) {
    static const GaussLegendre<8> rule;
    const double h = (b - a) / cells;
    double sum = 0;
    for (int c = 0; c < cells; ++c)
        for (std::size_t i = 0; i < 8; ++i) sum += rule.weight[i] * f(a + h * (c + rule.node[i]));
    return sum * h;
}

// ∫∫ f(x, y) over a rectangle.
template <typename F>
double integrate2(F&& f, double ax, double bx, double ay, double by, int cellsX = 32, int cellsY = 32) {
    return integrate([&](double x) { return integrate([&](double y) { return f(x, y); }, ay, by, cellsY); }, ax, bx,
                     cellsX);
}

} // namespace abbe::test

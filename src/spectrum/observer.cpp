#include "spectrum/observer.h"

#include <array>

namespace abbe {

namespace {

constexpr double kCmf[471][3] = {
#include "spectrum/data/cie1931.inl"
};

Spectrum component(const Wavelengths& w, int offset) {
    const float* base = detail::kObserver[0].value + offset;
    const Int8 index = w.cell * 8;
    const Float8 a = _mm256_i32gather_ps(base, reinterpret_cast<__m256i>(index), 4);
    const Float8 b = _mm256_i32gather_ps(base + 4, reinterpret_cast<__m256i>(index), 4);
    return fma(Spectrum(b - a), w.fraction, Spectrum(a));
}

// Simpson's rule on every cell: exact for the product of up to three linear functions.
template <typename F> Xyz integrateCells(const F& value) {
    double sum[3] = {};
    for (int i = 0; i < 470; ++i) {
        const auto [start, middle, end] = value(i);
        for (int c = 0; c < 3; ++c) {
            const double a = kCmf[i][c], b = kCmf[i + 1][c];
            sum[c] += (start * a + 4 * middle * 0.5 * (a + b) + end * b) / 6;
        }
    }
    return Xyz{sum[0], sum[1], sum[2]} * (1 / kYIntegral);
}

} // namespace

constinit const std::array<detail::ObserverCell, 470> detail::kObserver = [] {
    std::array<ObserverCell, 470> cells{};
    for (std::size_t i = 0; i < 470; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            cells[i].value[c] = static_cast<float>(kCmf[i][c]);
            cells[i].value[c + 4] = static_cast<float>(kCmf[i + 1][c]);
        }
    return cells;
}();

Spectrum xbar(const Wavelengths& w) { return component(w, 0); }
Spectrum ybar(const Wavelengths& w) { return component(w, 1); }
Spectrum zbar(const Wavelengths& w) { return component(w, 2); }

Xyz integrate(const Curve& f) {
    return integrateCells([&](int i) {
        const double a = f.at(360.0 + i), b = f.at(361.0 + i);
        return std::array<double, 3>{a, 0.5 * (a + b), b};
    });
}

Xyz integrate(const Curve& f, const Curve& g) {
    return integrateCells([&](int i) {
        const double fa = f.at(360.0 + i), fb = f.at(361.0 + i);
        const double ga = g.at(360.0 + i), gb = g.at(361.0 + i);
        return std::array<double, 3>{fa * ga, 0.25 * (fa + fb) * (ga + gb), fb * gb};
    });
}

} // namespace abbe

#include "spectrum/sensor.h"

#include "base/check.h"
#include "spectrum/named_spectra.h"
#include "spectrum/xyz.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

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

namespace {

using Signals = Xyz; // red, green, blue in the places of x, y, z

// At whole nanometres, linear between the figures and zero outside of them.
Signals signalsAt(const CameraSensitivities& camera, double nm) {
    const double place = (nm - CameraSensitivities::kFirstNm) / CameraSensitivities::kStepNm;
    if (place < 0 || place > CameraSensitivities::kCount - 1) return {};
    const auto i = std::min(static_cast<std::size_t>(place), std::size_t{CameraSensitivities::kCount - 2});
    const double t = place - static_cast<double>(i);
    const auto mix = [&](std::size_t c) { return (1 - t) * camera.rgb[i][c] + t * camera.rgb[i + 1][c]; };
    return {mix(0), mix(1), mix(2)};
}

// ∫ s(λ) f(λ) dλ where s is linear between its values at whole nanometres. Simpson's rule in every cell: exact if f is
// the product of up to two functions like s.
template <typename S, typename F> Xyz integrateCells(const S& s, const F& f) {
    Xyz sum;
    for (int nm = 360; nm < 830; ++nm) {
        const Xyz a = s(nm), b = s(nm + 1);
        sum += (a * f(nm) + (a + b) * (2 * f(nm + 0.5)) + b * f(nm + 1)) * (1.0 / 6);
    }
    return sum;
}

// Symmetric 3×3 from signals, Σ a bᵀ.
void addOuter(Matrix3& m, const Xyz& a, const Xyz& b) {
    const double x[3] = {a.x, a.y, a.z}, y[3] = {b.x, b.y, b.z};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m.m[i][j] += x[i] * y[j];
}

double dot(const Xyz& a, const Xyz& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// The M that minimises Σ |M sₖ - tₖ|² among those with M s₀ = t₀: by Lagrange's multipliers the free solution, plus
// (t₀ - M s₀) qᵀ / (qᵀ s₀) with q = (Σ s sᵀ)⁻¹ s₀.
Matrix3 fit(const std::vector<std::pair<Signals, Xyz>>& pairs, const Signals& s0, const Xyz& t0) {
    Matrix3 squares{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}, products = squares;
    for (const auto& [s, t] : pairs) {
        addOuter(squares, s, s);
        addOuter(products, t, s);
    }
    const Matrix3 inverse = squares.inverse();
    Matrix3 m = products * inverse;
    const Xyz q = inverse.apply<Xyz>(s0);
    addOuter(m, t0 - m.apply<Xyz>(s0), q * (1 / dot(q, s0)));
    return m;
}

} // namespace

Sensor::Sensor(const CameraSensitivities& camera, const Curve& light) {
    const auto signals = [&](double nm) { return signalsAt(camera, nm); };
    const auto lightAt = [&](double nm) { return light.at(nm); };
    const Signals white = integrateCells(signals, lightAt);
    ABBE_CHECK(white.x > 0 && white.y > 0 && white.z > 0);
    std::vector<std::pair<Signals, Xyz>> pairs;
    for (int i = 1; i <= 24; ++i) {
        const auto patch = reflectanceCurve(*findMeasured(fmt::format("macbeth-{}", i)));
        pairs.emplace_back(integrateCells(signals, [&](double nm) { return light.at(nm) * patch->at(nm); }),
                           abbe::integrate(*patch, light) * kYIntegral);
    }
    const Matrix3 m = fit(pairs, white, abbe::integrate(light) * kYIntegral);
    // The matrix goes into the table: after that the camera is an observer like the other.
    auto table = std::make_unique<Table>();
    for (std::size_t i = 0; i < table->size(); ++i)
        for (std::size_t end = 0; end < 2; ++end) {
            const Xyz v = m.apply<Xyz>(signalsAt(camera, 360.0 + static_cast<double>(i + end)));
            float* cell = (*table)[i].value + 4 * end;
            cell[0] = static_cast<float>(v.x);
            cell[1] = static_cast<float>(v.y);
            cell[2] = static_cast<float>(v.z);
            cell[3] = 0;
        }
    table_ = std::move(table);
    cells_ = table_->data();
}

Xyz Sensor::integrate(const Curve& f) const {
    const auto node = [&](int nm) {
        const float* value = nm < 830 ? cells_[nm - 360].value : cells_[469].value + 4;
        return Xyz{value[0], value[1], value[2]};
    };
    return integrateCells(node, [&](double nm) { return f.at(nm); }) * (1 / kYIntegral);
}

const CameraSensitivities* findSensitivities(std::string_view name) {
    const auto all = data::cameras();
    const auto found = std::ranges::find(all, name, &CameraSensitivities::name);
    return found == all.end() ? nullptr : &*found;
}

std::vector<std::string_view> sensorNames() {
    std::vector<std::string_view> names;
    for (const CameraSensitivities& camera : data::cameras()) names.push_back(camera.name);
    return names;
}

} // namespace abbe

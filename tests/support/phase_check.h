// Phase functions against their own claims: integrals over the sphere, and what is sampled is what is evaluated.
#pragma once

#include "render/medium.h"
#include "support/chi_square.h"

#include <doctest/doctest.h>

namespace abbe::test {

// The sphere in rings between cosines that lie halfway between two numbers of single precision, so that rounding moves
// no sample to another ring. They crowd around both poles, where lobes are.
class Rings {
  public:
    // `width` of the lobes, rad; at least 0.002.
    explicit Rings(double width, int count = 160) {
        const CrowdedCells angles(0, kPiD / 2, 0, width, count / 2);
        std::vector<double> half;
        for (int i = 0; i <= count / 2; ++i) half.push_back(2 * square(std::sin(angles.at(2.0 * i / count) / 2)));
        for (const double t : half) edges_.push_back(t > 0 ? (std::floor(t * 0x1p24) + 0.5) * 0x1p-24 : 0);
        for (int i = count / 2 - 1; i >= 0; --i) edges_.push_back(2 - edges_[static_cast<std::size_t>(i)]);
    }
    std::size_t count() const { return edges_.size() - 1; }
    std::size_t ring(float cosine) const {
        const double t = 1 - static_cast<double>(cosine);
        const auto above = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, t);
        return static_cast<std::size_t>(above - edges_.begin()) - 1;
    }
    // ∫ f(cos) over each, by the midpoint rule.
    template <typename F> std::vector<double> integrals(F&& f, int steps = 200) const {
        std::vector<double> result;
        for (std::size_t i = 0; i < count(); ++i) {
            const double h = (edges_[i + 1] - edges_[i]) / steps;
            double sum = 0;
            for (int k = 0; k < steps; ++k) sum += f(static_cast<float>(1 - (edges_[i] + (k + 0.5) * h)));
            result.push_back(2 * kPiD * sum * h);
        }
        return result;
    }
    template <typename F> double integral(F&& f, int steps = 200) const {
        const std::vector<double> parts = integrals(f, steps);
        return std::accumulate(parts.begin(), parts.end(), 0.0);
    }

  private:
    std::vector<double> edges_; // in 1 - cos
};

struct PhaseClaims {
    double width = 0.05;    // of the lobes, rad
    double accuracy = 1e-3; // of integrals by quadrature
    double meanCosine = 0;
};

inline void checkPhase(const PhaseFunction& phase, const PhaseClaims& claims) {
    const Rings rings(claims.width);
    const auto value = [&](float c) { return static_cast<double>(phase.value(c)); };
    std::vector<double> expected = rings.integrals(value);
    CHECK(std::accumulate(expected.begin(), expected.end(), 0.0) == doctest::Approx(1).epsilon(claims.accuracy));
    const double mean = rings.integral([&](float c) { return static_cast<double>(c) * value(c); });
    CHECK(std::abs(mean - claims.meanCosine) < 2 * claims.accuracy);
    const int samples = chiSquareSamples();
    for (double& e : expected) e *= samples;
    std::vector<double> observed(rings.count());
    Random random(11);
    bool inside = true;
    for (int i = 0; i < samples; ++i) {
        const float c = phase.sampleCosine(random.uniform());
        inside &= std::abs(c) <= 1;
        ++observed[rings.ring(c)];
    }
    CHECK(inside);
    CHECK(chiSquareTest(observed, expected).pValue > 1e-4);
    for (const float u : {0.f, 0x1p-30f, 0.5f, 1 - 0x1p-24f}) {
        const float c = phase.sampleCosine(u);
        CHECK(std::abs(c) <= 1);
        CHECK((std::isfinite(phase.value(c)) && phase.value(c) > 0));
    }
    for (const float c : {-1.f, 1.f}) CHECK((std::isfinite(phase.value(c)) && phase.value(c) >= 0));
}

// Its densities at single wavelengths have integral 1; ratios are finite everywhere.
inline void checkRatio(const PhaseFunction& phase, const PhaseClaims& claims) {
    const Rings rings(claims.width);
    const Wavelengths lambda =
        Wavelengths::at(Spectrum(Float8{360, 391.3f, 450, 500, 538.5f, 600, 700, 830}), Spectrum(1.f));
    std::vector<double> integrals(kLanes);
    for (int lane = 0; lane < kLanes; ++lane)
        CHECK(
            rings.integral([&](float c) { return static_cast<double>(phase.value(c) * phase.ratio(c, lambda)[lane]); },
                           60) == doctest::Approx(1).epsilon(claims.accuracy));
    bool sound = true;
    for (int i = 0; i <= 10'000; ++i) {
        const Spectrum ratio = phase.ratio(static_cast<float>(std::cos(kPiD * i / 10'000)), lambda);
        for (int lane = 0; lane < kLanes; ++lane) sound &= std::isfinite(ratio[lane]) && ratio[lane] >= 0;
    }
    CHECK(sound);
}

} // namespace abbe::test

// What every scattering function is asked. Materials are made with single-wavelength spectra unless a test says more.
#pragma once

#include "math/warp.h"
#include "render/material.h"
#include "spectrum/curve.h"
#include "support/chi_square.h"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace abbe::test {

// An index that falls with wavelength: a + b/λ², λ in µm [Cauchy1836].
class CauchyCurve final : public Curve {
  public:
    CauchyCurve(double a, double b) : a_(a), b_(b) {}
    Spectrum at(const Wavelengths& w) const override {
        return Spectrum(static_cast<float>(a_) + static_cast<float>(b_ * 1e6) / (w.nm.v * w.nm.v));
    }
    double at(double nm) const override { return a_ + b_ * 1e6 / (nm * nm); }
    bool isConstant() const override { return false; }
    double minimum() const override { return at(830); }
    double maximum() const override { return at(360); }

  private:
    double a_, b_;
};

// One scattering function in its own arena, with what a test must know of it.
struct BsdfUnderTest {
    BsdfUnderTest(std::string label, std::unique_ptr<const Material> made, float width, float index = 0,
                  Wavelengths wavelengths = Wavelengths::single(550))
        : name(std::move(label)), alpha(width), eta(index), material(std::move(made)), arena(std::make_unique<Arena>()),
          bsdf(material->bsdf({}, wavelengths, *arena)) {}

    std::string name;
    float alpha; // width of the lobe; 0 for delta lobes
    float eta;   // index of the inside; 0 if opaque
    std::unique_ptr<const Material> material;
    std::unique_ptr<Arena> arena;
    const Bsdf* bsdf;
};

inline Vec3 directionAt(double degrees, double azimuth = 0.3) {
    const double t = degrees * kPiD / 180;
    return Vec3(Vec3d{std::sin(t) * std::cos(azimuth), std::sin(t) * std::sin(azimuth), std::cos(t)});
}
inline Vec3 mirrored(Vec3 w) { return {w.x, w.y, -w.z}; }

// Cells for wi on one side, crowded around the mirrored or refracted direction.
inline HemisphereCells cellsFor(const BsdfUnderTest& b, Vec3 wo, bool upper, int count = 24) {
    const bool reflected = upper == (wo.z > 0);
    Vec3d centre{-wo.x, -wo.y, wo.z};
    double width = b.alpha;
    if (!reflected) {
        const double eta = wo.z > 0 ? b.eta : 1 / b.eta, s2 = (wo.x * wo.x + wo.y * wo.y) / (eta * eta);
        centre = Vec3d{-wo.x / eta, -wo.y / eta, -std::copysign(std::sqrt(std::max(1e-4, 1 - s2)), wo.z)};
        width *= std::abs(1 - 1 / eta);
    }
    HemisphereCells cells(upper, normalize(centre), std::min(1.0, width), count, count);
    // Where the microfacet between wo and a refracted wi stands upright, its density ends with a jump.
    if (!reflected) cells.jumpsAt(std::abs(wo.z) / (wo.z > 0 ? b.eta : 1 / b.eta));
    return cells;
}

// Numbers in the unit cube that fill it evenly: Hammersley's points in bases 2 and 3.
struct EvenPoints {
    explicit EvenPoints(int n) : count(n) {}
    int count;
    struct Point {
        float lobe;
        Vec2 u;
    };
    Point operator()(int i) const {
        const auto inUnit = [](double x) { return std::min(static_cast<float>(x), kOneMinusEpsilon); };
        return {inUnit(radicalInverse(i, 3)), {inUnit(radicalInverse(i, 2)), inUnit((i + 0.5) / count)}};
    }

  private:
    static double radicalInverse(int i, int base) {
        double result = 0, digit = 1.0 / base;
        for (; i > 0; i /= base, digit /= base) result += digit * (i % base);
        return result;
    }
};

// Mean over samples of f(sample), 0 for those that end the path.
template <typename F> double meanOfSamples(const Bsdf& bsdf, Vec3 wo, Transport transport, int count, F&& f) {
    const EvenPoints points(count);
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const auto p = points(i);
        if (const auto s = bsdf.sample(wo, p.lobe, p.u, transport)) sum += f(*s);
    }
    return sum / count;
}

} // namespace abbe::test

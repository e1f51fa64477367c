// Functions of wavelength: reflectance, radiance, refractive index, …; units are their users'.
#pragma once

#include "spectrum/spectrum.h"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace abbe {

// Immutable after construction; shared between threads.
class Curve {
  public:
    virtual ~Curve() = default;
    virtual Spectrum at(const Wavelengths&) const = 0;
    // One wavelength in nm, clamped to [360, 830].
    virtual double at(double nanometres) const = 0;
    // True if the value is the same at every wavelength (bit for bit).
    virtual bool isConstant() const = 0;
    // Bounds over [360, 830].
    virtual double minimum() const = 0;
    virtual double maximum() const = 0;
};

// The common curve: a 1 nm table from 360 to 830 nm, linear in between. 5 nm data are exact in it, lights keep their
// lines.
class SampledCurve final : public Curve {
  public:
    static constexpr int kSize = 471;

    // Value f(nm) at each whole nanometre.
    explicit SampledCurve(const std::function<double(double)>& f);
    // Linear interpolation of (nm, value) points with increasing nm; constant beyond both ends. For reflectances and
    // other smooth quantities.
    static SampledCurve fromPoints(std::span<const double> nm, std::span<const double> values);
    // Energy-preserving: node i receives ∫ f(λ) hat_i(λ) dλ of the piecewise-linear data, so that lines between nodes
    // keep their power. Zero beyond both ends. For emission.
    static SampledCurve fromEmissionPoints(std::span<const double> nm, std::span<const double> values);

    Spectrum at(const Wavelengths& w) const override { return interpolate(table_.data(), w.cell, w.fraction); }
    double at(double nanometres) const override;
    bool isConstant() const override { return minimum_ == maximum_; }
    double minimum() const override { return minimum_; }
    double maximum() const override { return maximum_; }

  private:
    explicit SampledCurve(const std::array<double, kSize>&);
    std::array<float, kSize> table_;
    double minimum_ = 0, maximum_ = 0;
};

// The same value everywhere: the common case of a plain number in a scene.
class ConstantCurve final : public Curve {
  public:
    explicit ConstantCurve(double value) : value_(value) {}
    Spectrum at(const Wavelengths&) const override { return Spectrum(static_cast<float>(value_)); }
    double at(double) const override { return value_; }
    bool isConstant() const override { return true; }
    double minimum() const override { return value_; }
    double maximum() const override { return value_; }

  private:
    double value_;
};

} // namespace abbe

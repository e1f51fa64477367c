#include "spectrum/dispersion.h"

#include "base/check.h"
#include "math/vec.h"
#include "spectrum/curve.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace abbe {

CauchyCurve::CauchyCurve(double a, double b, double c, double minNm, double maxNm)
    : a_(a), b_(b), c_(c), minNm_(static_cast<float>(minNm)), maxNm_(static_cast<float>(maxNm)) {
    minimum_ = maximum_ = at(double{kMinWavelength});
    for (int nm = 361; nm <= 830; ++nm) {
        const double n = at(static_cast<double>(nm));
        minimum_ = std::min(minimum_, n);
        maximum_ = std::max(maximum_, n);
    }
}

double CauchyCurve::at(double nanometres) const {
    const double nm = std::clamp(std::clamp<double>(nanometres, kMinWavelength, kMaxWavelength),
                                 static_cast<double>(minNm_), static_cast<double>(maxNm_));
    const double inverseSquare = 1e6 / (nm * nm);
    return a_ + (b_ + c_ * inverseSquare) * inverseSquare;
}

SellmeierCurve::SellmeierCurve(double constant, std::span<const double> strengths,
                               std::span<const double> squaredResonances, double minNm, double maxNm)
    : constant_(constant), constantPlusOne_(static_cast<float>(1 + constant)), minNm_(static_cast<float>(minNm)),
      maxNm_(static_cast<float>(maxNm)), terms_(static_cast<int>(strengths.size())) {
    ABBE_CHECK(strengths.size() == squaredResonances.size() && strengths.size() <= kMaxTerms);
    bool resonant = false;
    const double low = std::max<double>(minNm_, kMinWavelength), high = std::min<double>(maxNm_, kMaxWavelength);
    for (std::size_t i = 0; i < strengths.size(); ++i) {
        exact_[2 * i] = strengths[i];
        exact_[2 * i + 1] = squaredResonances[i];
        strength_[i] = static_cast<float>(strengths[i]);
        resonance_[i] = static_cast<float>(squaredResonances[i]);
        const double c = squaredResonances[i] * 1e6; // nm²
        resonant |= strengths[i] != 0 && c >= square(low - 1) && c <= square(high + 1);
    }
    minimum_ = maximum_ = at(double{kMinWavelength});
    for (int nm = 361; nm <= 830; ++nm) {
        const double n = at(static_cast<double>(nm));
        resonant |= !std::isfinite(n);
        minimum_ = std::min(minimum_, n);
        maximum_ = std::max(maximum_, n);
    }
    if (resonant || !std::isfinite(minimum_)) {
        minimum_ = 0;
        maximum_ = HUGE_VAL;
    }
}

double SellmeierCurve::at(double nanometres) const {
    const double nm = std::clamp(std::clamp<double>(nanometres, kMinWavelength, kMaxWavelength),
                                 static_cast<double>(minNm_), static_cast<double>(maxNm_));
    const double lambda2 = nm * nm * 1e-6;
    double n2 = 1 + constant_;
    for (std::size_t i = 0; i < static_cast<std::size_t>(terms_); ++i)
        n2 += exact_[2 * i] * lambda2 / (lambda2 - exact_[2 * i + 1]);
    return std::sqrt(n2);
}

namespace {

// Σ c[i] λ^c[i+1] from the given place.
double powerSum(std::span<const double> c, std::size_t from, double um) {
    double sum = 0;
    for (std::size_t i = from; i + 1 < c.size(); i += 2) sum += c[i] * std::pow(um, c[i + 1]);
    return sum;
}

double sellmeierSquare(const Dispersion& d, double um) {
    double square = 1 + d.coefficients[0];
    for (std::size_t i = 1; i + 1 < d.coefficients.size(); i += 2) {
        const double c = d.coefficients[i + 1];
        square += d.coefficients[i] * um * um / (um * um - (d.formula == DispersionFormula::sellmeier ? c * c : c));
    }
    return square;
}

double infoSquare(std::span<const double> c, double um) {
    double square = c[0];
    for (std::size_t i = 1; i + 3 < std::min<std::size_t>(c.size(), 9); i += 4)
        square += c[i] * std::pow(um, c[i + 1]) / (um * um - std::pow(c[i + 2], c[i + 3]));
    return square + powerSum(c, 9, um);
}

std::unique_ptr<Curve> makeSellmeier(const Dispersion& d) {
    std::vector<double> strengths, squares;
    for (std::size_t i = 1; i + 1 < d.coefficients.size(); i += 2) {
        const double c = d.coefficients[i + 1];
        strengths.push_back(d.coefficients[i]);
        squares.push_back(d.formula == DispersionFormula::sellmeier ? c * c : c);
    }
    return std::make_unique<SellmeierCurve>(d.coefficients[0], strengths, squares, d.minNm, d.maxNm);
}

// Cauchy's own exponents only: 0, -2, -4.
bool isPlainCauchy(std::span<const double> c) {
    return (c.size() == 3 && c[2] == -2) || (c.size() == 5 && c[2] == -2 && c[4] == -4);
}

} // namespace

double index(const Dispersion& d, double nanometres) {
    const double um = std::clamp(nanometres, d.minNm, d.maxNm) * 1e-3;
    switch (d.formula) {
    case DispersionFormula::sellmeier:
    case DispersionFormula::sellmeierSquared:
        return std::sqrt(sellmeierSquare(d, um));
    case DispersionFormula::polynomial:
        return std::sqrt(d.coefficients[0] + powerSum(d.coefficients, 1, um));
    case DispersionFormula::refractiveIndexInfo:
        return std::sqrt(infoSquare(d.coefficients, um));
    case DispersionFormula::cauchy:
        return d.coefficients[0] + powerSum(d.coefficients, 1, um);
    }
    return std::nan("");
}

std::unique_ptr<Curve> makeIndexCurve(const Dispersion& d) {
    const auto& c = d.coefficients;
    if ((d.formula == DispersionFormula::sellmeier || d.formula == DispersionFormula::sellmeierSquared) &&
        (c.size() - 1) / 2 <= SellmeierCurve::kMaxTerms)
        return makeSellmeier(d);
    if (d.formula == DispersionFormula::cauchy && isPlainCauchy(c))
        return std::make_unique<CauchyCurve>(c[0], c[1], c.size() == 5 ? c[3] : 0, d.minNm, d.maxNm);
    return std::make_unique<SampledCurve>([&d](double nm) { return index(d, nm); });
}

bool usableIndex(const Curve& curve) {
    if (!(curve.minimum() > 0.2 && curve.maximum() < 10)) return false;
    for (int nm = 360; nm <= 830; ++nm) {
        const double n = curve.at(static_cast<double>(nm));
        if (!(n > 0.2 && n < 10)) return false;
    }
    return true;
}

} // namespace abbe

#include "film/pixel_filter.h"

#include "base/check.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {

namespace {

struct FilterEntry {
    FilterShape shape;
    std::string_view name;
    double radius;
};
constexpr std::array<FilterEntry, 5> kFilters{{{FilterShape::box, "box", 0.5},
                                               {FilterShape::triangle, "triangle", 1},
                                               {FilterShape::gaussian, "gaussian", 1.5},
                                               {FilterShape::blackmanHarris, "blackman-harris", 1.5},
                                               {FilterShape::mitchell, "mitchell", 2}}};

// Share of the samples that go to mitchell's negative part. Near its natural share of the mass (0.066), so that both
// weights are of about equal size, and a power of two, so that a net of 16 points or more has exactly this share.
constexpr float kNegativeShare = 1.f / 16;

// x in [0, 2] [Mitchell1988, eq. 8] with B = C = 1/3.
double mitchell(double x) {
    if (x < 1) return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
    return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
}

// Four-term minimum window [Harris1978, table 1]; x in [-1, 1].
double blackmanHarris(double x) {
    const double phase = kPiD * (x + 1);
    return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2 * phase) - 0.01168 * std::cos(3 * phase);
}

// Where mitchell changes sign, for radius 2.
double mitchellZero() {
    double positive = 1, negative = 1.5;
    for (int i = 0; i < 60; ++i) {
        const double middle = (positive + negative) / 2;
        (mitchell(middle) > 0 ? positive : negative) = middle;
    }
    return positive;
}

// u with [begin, begin + share) stretched to [0, 1).
float stretch(float u, float begin, float share) { return std::min((u - begin) / share, kOneMinusEpsilon); }

} // namespace

std::string_view name(FilterShape shape) {
    return std::find_if(kFilters.begin(), kFilters.end(), [&](const FilterEntry& e) { return e.shape == shape; })->name;
}

std::optional<FilterShape> findFilter(std::string_view name) {
    for (const FilterEntry& e : kFilters)
        if (e.name == name) return e.shape;
    return std::nullopt;
}

double defaultRadius(FilterShape shape) {
    return std::find_if(kFilters.begin(), kFilters.end(), [&](const FilterEntry& e) { return e.shape == shape; })
        ->radius;
}

double PixelFilter::evaluate(FilterShape shape, double radius, double x) {
    const double t = std::abs(x) / radius;
    if (t > 1) return 0;
    switch (shape) {
    case FilterShape::box:
        return 1;
    case FilterShape::triangle:
        return 1 - t;
    case FilterShape::gaussian:
        return std::exp(-4.5 * t * t); // σ = radius/3
    case FilterShape::blackmanHarris:
        return blackmanHarris(t);
    case FilterShape::mitchell:
        return mitchell(2 * t);
    }
    return 0;
}

PixelFilter::Magnitude::Magnitude(FilterShape shape, double radius, double begin, double end) {
    constexpr int kSteps = 1 << 14;
    const double step = (end - begin) / kSteps;
    const auto density = [&](double x) { return std::abs(evaluate(shape, radius, x)); };
    std::vector<double> beyond(kSteps + 1); // ∫ from the i-th place to the end, by Simpson's rule
    for (int i = kSteps - 1; i >= 0; --i) {
        const double x = begin + i * step;
        beyond[i] = beyond[i + 1] + (density(x) + 4 * density(x + step / 2) + density(x + step)) * step / 6;
    }
    mass_ = beyond[0];
    table_.resize(kCells + 1);
    int place = kSteps - 1;
    for (int cell = 0; cell <= kCells; ++cell) {
        const double wanted = static_cast<double>(cell) / kCells;
        while (place > 0 && std::sqrt(beyond[place] / mass_) < wanted) --place;
        const double far = std::sqrt(beyond[place + 1] / mass_), near = std::sqrt(beyond[place] / mass_);
        const double fraction = std::clamp((wanted - far) / (near - far), 0.0, 1.0);
        table_[cell] = static_cast<float>(begin + (place + 1 - fraction) * step);
    }
}

float PixelFilter::Magnitude::sample(float u) const noexcept {
    const float side = 2 * u - 1;
    const float position = std::sqrt(1 - std::abs(side)) * kCells;
    const int cell = std::min(static_cast<int>(position), kCells - 1);
    const float a = table_[cell], b = table_[cell + 1];
    return std::copysign(a + (b - a) * (position - static_cast<float>(cell)), side);
}

namespace {

// By Simpson's rule: exact for box, triangle and mitchell's polynomials, whose pieces end at its steps.
double integralOf(FilterShape shape, double radius) {
    constexpr int kSteps = 1024;
    const double step = radius / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        sum += PixelFilter::evaluate(shape, radius, i * step) +
               4 * PixelFilter::evaluate(shape, radius, (i + 0.5) * step) +
               PixelFilter::evaluate(shape, radius, (i + 1) * step);
    return sum * step / 3;
}

} // namespace

PixelFilter::PixelFilter(FilterShape shape, double radius)
    : shape_(shape), radius_(radius), perCell_(static_cast<float>(kWeights / radius)) {
    ABBE_CHECK(radius > 0);
    const double integral = integralOf(shape, radius);
    for (int i = 0; i <= kWeights; ++i)
        weights_.push_back(static_cast<float>(evaluate(shape, radius, radius * i / kWeights) / integral));
    if (shape == FilterShape::box) return;
    if (shape != FilterShape::mitchell) {
        positive_ = Magnitude(shape, radius, 0, radius);
        return;
    }
    const double zero = mitchellZero() * radius / 2;
    positive_ = Magnitude(shape, radius, 0, zero);
    negative_ = Magnitude(shape, radius, zero, radius);
    const double p = positive_.mass(), n = negative_.mass(), total = square(p - n);
    bothNegative_ = static_cast<float>(n * n / (p * p + n * n));
    positiveWeight_ = static_cast<float>((p * p + n * n) / (total * (1 - kNegativeShare)));
    negativeWeight_ = static_cast<float>(-2 * p * n / (total * kNegativeShare));
}

FilterSample PixelFilter::sample(Vec2 u) const noexcept {
    if (shape_ == FilterShape::mitchell) return sampleSigned(u);
    if (shape_ == FilterShape::box) {
        const auto r = static_cast<float>(radius_);
        return {{(2 * u.x - 1) * r, (2 * u.y - 1) * r}, 1};
    }
    return {{positive_.sample(u.x), positive_.sample(u.y)}, 1};
}

// The product f(x) f(y) is negative where one factor is. Which part a sample belongs to is decided by u.x alone: its
// first sixteenth goes to the negative part. Dividing by the sum of the weights instead would need no such care, but is
// biased, and its denominator can vanish.
FilterSample PixelFilter::sampleSigned(Vec2 u) const noexcept {
    if (u.x < kNegativeShare) {
        const float v = stretch(u.x, 0, kNegativeShare);
        if (v < 0.5f) return {{negative_.sample(2 * v), positive_.sample(u.y)}, negativeWeight_};
        return {{positive_.sample(2 * v - 1), negative_.sample(u.y)}, negativeWeight_};
    }
    const float v = stretch(u.x, kNegativeShare, 1 - kNegativeShare);
    if (v < bothNegative_) {
        const float w = stretch(v, 0, bothNegative_);
        return {{negative_.sample(w), negative_.sample(u.y)}, positiveWeight_};
    }
    const float w = stretch(v, bothNegative_, 1 - bothNegative_);
    return {{positive_.sample(w), positive_.sample(u.y)}, positiveWeight_};
}

} // namespace abbe

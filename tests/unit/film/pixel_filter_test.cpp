#include "film/pixel_filter.h"
#include "math/sobol.h"

#include <doctest/doctest.h>

using namespace abbe;

namespace {

constexpr FilterShape kShapes[] = {FilterShape::box, FilterShape::triangle, FilterShape::gaussian,
                                   FilterShape::blackmanHarris, FilterShape::mitchell};

// ∫ f(x) x^power dx / ∫ f(x) dx by the midpoint rule.
double moment(FilterShape shape, double radius, int power) {
    constexpr int kSteps = 200000;
    double sum = 0, mass = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double x = radius * (2 * (i + 0.5) / kSteps - 1), f = PixelFilter::evaluate(shape, radius, x);
        sum += f * std::pow(x, power);
        mass += f;
    }
    return sum / mass;
}

// Weighted averages over 2^20 points.
struct Moments {
    double one = 0, x = 0, y = 0, xx = 0, yy = 0, xxxx = 0, xxyy = 0;
};
Moments sampledMoments(const PixelFilter& filter) {
    constexpr std::uint32_t kCount = 1u << 20;
    Moments m;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        alignas(32) float u[kSobolDimensions];
        scrambledSobol16(i, 12345, u);
        const FilterSample s = filter.sample({u[0], u[1]});
        const double w = static_cast<double>(s.weight) / kCount, x = s.offset.x, y = s.offset.y;
        m.one += w;
        m.x += w * x;
        m.y += w * y;
        m.xx += w * x * x;
        m.yy += w * y * y;
        m.xxxx += w * x * x * x * x;
        m.xxyy += w * x * x * y * y;
    }
    return m;
}

} // namespace

TEST_CASE("filters keep the shapes that they are named for") {
    CHECK(PixelFilter::evaluate(FilterShape::mitchell, 2, 0) == doctest::Approx(8.0 / 9));
    CHECK(PixelFilter::evaluate(FilterShape::mitchell, 2, 1) == doctest::Approx(1.0 / 18));
    CHECK(PixelFilter::evaluate(FilterShape::mitchell, 2, 1.5) < 0);
    CHECK(PixelFilter::evaluate(FilterShape::blackmanHarris, 1.5, 0) == doctest::Approx(1));
    CHECK(PixelFilter::evaluate(FilterShape::blackmanHarris, 1.5, 1.5) == doctest::Approx(6e-5).epsilon(0.01));
    CHECK(PixelFilter::evaluate(FilterShape::gaussian, 1.5, 0.5) == doctest::Approx(std::exp(-0.5)));
    for (const FilterShape shape : kShapes) {
        CHECK(PixelFilter::evaluate(shape, 1.5, 1.51) == 0);
        CHECK(findFilter(name(shape)) == shape);
        CHECK(defaultRadius(shape) > 0);
    }
    CHECK(!findFilter("lanczos"));
}

TEST_CASE("pixel filter: the table of weights is the filter") {
    for (const FilterShape shape : {FilterShape::box, FilterShape::triangle, FilterShape::gaussian,
                                    FilterShape::blackmanHarris, FilterShape::mitchell}) {
        const double radius = defaultRadius(shape) * 1.3;
        const PixelFilter filter(shape, radius);
        double sum = 0, worst = 0;
        constexpr int steps = 20011;
        for (int i = 0; i < steps; ++i) {
            const double x = ((i + 0.5) / steps * 2 - 1) * radius;
            sum += static_cast<double>(filter.weight(static_cast<float>(x))) * 2 * radius / steps;
            const double exact = PixelFilter::evaluate(shape, radius, x) / PixelFilter::evaluate(shape, radius, 0);
            const double found = static_cast<double>(filter.weight(static_cast<float>(x)) / filter.weight(0));
            worst = std::max(worst, std::abs(found - exact));
        }
        CAPTURE(name(shape));
        CHECK(sum == doctest::Approx(1).epsilon(1e-5));
        CHECK(worst < 5e-6);
        CHECK(filter.weight(static_cast<float>(radius * 1.001)) == 0);
    }
}

TEST_CASE("weighted samples have the filter's integral and moments") {
    for (const FilterShape shape : kShapes)
        for (const double radius : {0.5, 1.5, 3.0}) {
            CAPTURE(name(shape));
            const PixelFilter filter(shape, radius);
            const double variance = moment(shape, radius, 2), fourth = moment(shape, radius, 4);
            const Moments m = sampledMoments(filter);
            CHECK(m.one == doctest::Approx(1).epsilon(1e-6));
            CHECK(std::abs(m.x) < 1e-5 * radius);
            CHECK(std::abs(m.y) < 1e-5 * radius);
            CHECK(m.xx == doctest::Approx(variance).epsilon(2e-4));
            CHECK(m.yy == doctest::Approx(variance).epsilon(2e-4));
            CHECK(m.xxxx == doctest::Approx(fourth).epsilon(2e-3));
            CHECK(m.xxyy == doctest::Approx(variance * variance).epsilon(1e-3));
        }
}

TEST_CASE("samples stay within the radius for every u") {
    const float edge[] = {0, 1e-9f, 1.f / 32, 1.f / 16, 0.5f, std::nextafter(0.5f, 0.f), kOneMinusEpsilon};
    for (const FilterShape shape : kShapes) {
        const PixelFilter filter(shape, 1.5);
        for (const float u : edge)
            for (const float v : edge) {
                const FilterSample s = filter.sample({u, v});
                CHECK(std::abs(s.offset.x) <= 1.5f);
                CHECK(std::abs(s.offset.y) <= 1.5f);
                CHECK(std::isfinite(s.weight));
            }
    }
}

TEST_CASE("a constant image stays constant with negative lobes") {
    const PixelFilter filter(FilterShape::mitchell, 2);
    for (std::uint32_t seed = 0; seed < 64; ++seed)
        for (const std::uint32_t count : {16u, 48u, 1024u}) {
            double weights = 0;
            std::uint32_t negative = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                alignas(32) float u[kSobolDimensions];
                scrambledSobol16(i, seed * 0x9e3779b9u, u);
                const float w = filter.sample({u[0], u[1]}).weight;
                weights += w;
                negative += w < 0;
            }
            CHECK(negative == count / 16);
            CHECK(weights / count == doctest::Approx(1).epsilon(1e-6));
        }
}

TEST_CASE("non-negative filters have weight 1 always") {
    for (const FilterShape shape : kShapes)
        if (shape != FilterShape::mitchell) CHECK(PixelFilter(shape, 2).sample({0.01f, 0.3f}).weight == 1);
}

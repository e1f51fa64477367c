// How fast errors fall with the number of samples, on integrands whose rates are known [Owen1997b].
#include "support/scene_test_convergence.h"
#include "support/statistics.h"
#include "transport/sampler.h"

#include <doctest/doctest.h>
#include <string>

namespace abbe::test {
namespace {

// RMSE against the exact integral over independent scrambles, for 64 to 4096 samples, and its slope.
template <typename F> SlopeFit slope(F&& f, double exact, bool random) {
    constexpr int scrambles = 96;
    std::vector<RatePoint> points;
    for (std::uint32_t n = 64; n <= 4096; n *= 2) {
        Moments squares;
        for (int k = 0; k < scrambles; ++k) {
            Sampler s;
            s.startPixel(mix64(static_cast<std::uint64_t>(k) * 977 + n),
                         random ? Technique::Numbers::random : Technique::Numbers::sobol, true);
            double sum = 0;
            for (std::uint32_t i = 0; i < n; ++i) {
                s.start(i);
                sum += f(s);
            }
            squares.add(square(sum / n - exact));
        }
        points.push_back({static_cast<double>(n), squares.mean(), squares.standardError()});
    }
    return fitSlope(points);
}

// Checks the slopes of RMSE: that of random numbers is -1/2, and Owen-scrambled points reach at least `joint`.
template <typename F> void checkSlopes(const char* name, F&& f, double exact, double joint) {
    const SlopeFit random = slope(f, exact, true), owen = slope(f, exact, false);
    INFO(std::string(name) << ": random " << random.slope << " ± " << random.error << ", Owen " << owen.slope << " ± "
                           << owen.error);
    CHECK(std::abs(random.slope + 0.5) < 0.06);
    CHECK(std::abs(owen.slope - joint) < 0.12);
}

} // namespace

// The slopes are those of the order of dimensions in sampler.h: the best pair goes to the first bounce.
TEST_CASE("convergence of the sampler: smooth functions") {
    const auto product = [](Vec2 u) { return static_cast<double>(u.x) * static_cast<double>(u.y); };
    checkSlopes(
        "x y over the first bounce", [&](Sampler& s) { return product(s.vertex(0).bsdf); }, 0.25, -1.45);
    checkSlopes(
        "x y over the film", [&](Sampler& s) { return product(s.film()); }, 0.25, -1.32);
    checkSlopes(
        "product over the first bounce and the light it meets",
        [&](Sampler& s) { return 16 * product(s.vertex(0).bsdf) * product(s.vertex(1).light); }, 1, -1.31);
    checkSlopes(
        "product over film and light", [&](Sampler& s) { return 16 * product(s.film()) * product(s.vertex(0).light); },
        1, -1.13);
}

TEST_CASE("convergence of the sampler: edges") {
    checkSlopes(
        "disc over the film", [](Sampler& s) { return square(s.film().x) + square(s.film().y) < 0.64f ? 1.0 : 0.0; },
        kPiD * 0.16, -0.76);
    checkSlopes(
        "edge over the film times a smooth function of the light",
        [](Sampler& s) {
            const Vec2 l = s.vertex(0).light;
            return s.film().x + 0.7f * s.film().y < 0.8f ? 4 * static_cast<double>(l.x * l.y) : 0.0;
        },
        // ∫ of the edge: x < 0.8 - 0.7 y, for all y in [0, 1].
        0.8 - 0.35, -0.72);
}

TEST_CASE("convergence of the sampler: padded dimensions still gain, but less") {
    const auto padded = [](Sampler& s) {
        const Vec2 a = s.vertex(4).light, b = s.vertex(5).light;
        return 16 * static_cast<double>(a.x * a.y) * static_cast<double>(b.x * b.y);
    };
    const SlopeFit fit = slope(padded, 1, false);
    INFO(fit.slope << " ± " << fit.error);
    CHECK(std::abs(fit.slope + 0.52) < 0.06);
}

} // namespace abbe::test

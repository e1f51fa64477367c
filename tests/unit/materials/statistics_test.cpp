// The statistical helpers themselves, against published values.
#include "math/warp.h"
#include "support/chi_square.h"
#include "support/jacobian.h"
#include "support/statistics.h"

#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("p-values agree with tables") {
    CHECK(chiSquareUpper(3.841458821, 1) == doctest::Approx(0.05).epsilon(1e-8));
    CHECK(chiSquareUpper(18.307038, 10) == doctest::Approx(0.05).epsilon(1e-6));
    CHECK(chiSquareUpper(1000, 1000) == doctest::Approx(0.49405285).epsilon(1e-6));
    CHECK(studentTwoSided(2.364624251, 7) == doctest::Approx(0.05).epsilon(1e-8));
    CHECK(studentTwoSided(12.7062047, 1) == doctest::Approx(0.05).epsilon(1e-7));
    CHECK(normalTwoSided(1.959963985) == doctest::Approx(0.05).epsilon(1e-8));
    CHECK(kolmogorovUpper(1.358099) == doctest::Approx(0.05).epsilon(1e-5));
    CHECK(sidak(0.05, 10) == doctest::Approx(0.005116197).epsilon(1e-6));
}

TEST_CASE("chi-square accepts the right density and rejects one that is 3 % off") {
    Random random(1);
    const HemisphereCells cells(true, {0, 0, 1}, 1.0);
    const auto sample = [&] {
        return std::optional(Vec3d(squareToCosineHemisphere({random.uniform(), random.uniform()})));
    };
    const auto right = [](Vec3d w) { return w.z / kPiD; };
    const auto wrong = [](Vec3d w) { return w.z / kPiD * (1 + 0.03 * w.x / std::hypot(w.x, w.y)); };
    CHECK(cells.integral(right) == doctest::Approx(1).epsilon(1e-6));
    CHECK(chiSquareDirections(cells, sample, right, 200000).pValue > 1e-3);
    CHECK(chiSquareDirections(cells, sample, wrong, 1000000).pValue < 1e-4);
}

TEST_CASE("cells crowd around a sharp lobe and still cover the hemisphere") {
    const HemisphereCells cells(true, normalize(Vec3d{0.6, 0.1, 0.7}), 1e-3);
    CHECK(cells.integral([](Vec3d w) { return w.z / kPiD; }) == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("Kolmogorov's test tells uniform from bent numbers") {
    Random random(2);
    std::vector<double> even, bent;
    for (int i = 0; i < 5000; ++i) {
        even.push_back(random.uniformDouble());
        bent.push_back(std::pow(random.uniformDouble(), 1.1));
    }
    CHECK(kolmogorovUniform(even) > 1e-3);
    CHECK(kolmogorovUniform(bent) < 1e-3);
}

TEST_CASE("the Jacobian of the cosine warp is one over its density") {
    const Vec2 u{0.3f, 0.7f};
    const auto j = jacobian([](Vec2 v) { return std::optional(squareToCosineHemisphere(v)); }, u, 1e-3f);
    CHECK(*j * cosineHemispherePdf(squareToCosineHemisphere(u).z) == doctest::Approx(1).epsilon(1e-3));
}

} // namespace abbe::test

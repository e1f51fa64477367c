#include "math/equiangular.h"

#include <doctest/doctest.h>
#include <vector>

namespace abbe::test {

TEST_CASE("equiangular distances have the density that they state") {
    const struct {
        Vec3 point;
        float tNear, tFar;
    } cases[] = {{{0.3f, 2, 0}, 0, 5},
                 {{3, 0.01f, 0}, 1, 4},
                 {{-2, 1, 0}, 0, kInfinity},
                 {{2, 0, 0}, 0, 10},
                 {{1e4f, 3, 1}, 0, kInfinity}};
    for (const auto& c : cases) {
        const EquiangularDistances d({0, 0, 0}, {1, 0, 0}, c.point, c.tNear, c.tFar);
        REQUIRE(d.valid());
        // u as the distribution function of t: its slope is the density.
        for (int i = 1; i < 200; ++i) {
            const float u = static_cast<float>(i) / 200, step = 1.f / 4096;
            const float a = d.sample(u - step), b = d.sample(u + step);
            CAPTURE(u);
            CHECK((a >= c.tNear && b <= c.tFar && a <= b));
            if (!(b < 1e3f * length(c.point))) continue;
            // Simpson's rule between the two.
            const double mass =
                static_cast<double>(b - a) / 6 * static_cast<double>(d.pdf(a) + 4 * d.pdf(0.5f * (a + b)) + d.pdf(b));
            CHECK(mass == doctest::Approx(static_cast<double>(2 * step)).epsilon(0.05));
        }
        CHECK(d.pdf(c.tNear - 1) == 0);
    }
}

TEST_CASE("no distances where a range has no width") {
    CHECK_FALSE(EquiangularDistances({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, 2, 2).valid());
    CHECK_FALSE(EquiangularDistances({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, 3, 2).valid());
}

} // namespace abbe::test

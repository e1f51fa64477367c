#include "spectrum/color_space.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

void checkMatrix(const Matrix3& m, const double (&expected)[3][3], double tolerance) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            CAPTURE(i);
            CAPTURE(j);
            CHECK(std::abs(m.m[i][j] - expected[i][j]) < tolerance);
        }
}

} // namespace

TEST_CASE("AP0 is the matrix of SMPTE ST 2065-1") {
    checkMatrix(rgb::ap0.fromXyz(),
                {{1.0498110175, 0, -0.0000974845}, {-0.4959030231, 1.3733130458, 0.0982400361}, {0, 0, 0.9912520182}},
                1e-8);
}

TEST_CASE("derived matrices agree with the published ones") {
    checkMatrix(rgb::rec709.toXyz(),
                {{0.412391, 0.357584, 0.180481}, {0.212639, 0.715169, 0.072192}, {0.019331, 0.119195, 0.950532}}, 1e-6);
    checkMatrix(rgb::rec2020.toXyz(),
                {{0.636958, 0.144617, 0.168881}, {0.262700, 0.677998, 0.059302}, {0, 0.028073, 1.060985}}, 1e-6);
    checkMatrix(rgb::ap1.toXyz(),
                {{0.6624541811, 0.1340042065, 0.1561876870},
                 {0.2722287168, 0.6740817658, 0.0536895174},
                 {-0.0055746495, 0.0040607335, 1.0103391003}},
                1e-8);
    checkMatrix(rgb::p3d65.toXyz(),
                {{0.486571, 0.265668, 0.198217}, {0.228975, 0.691739, 0.079287}, {0, 0.045113, 1.043944}}, 1e-6);
}

TEST_CASE("white is (1, 1, 1) and conversions are inverse to each other") {
    for (const auto name : rgbSpaceNames()) {
        CAPTURE(name);
        const auto space = findRgbSpace(name);
        REQUIRE(space);
        const Vec3d one = toRgb(whiteXyz(space->white), *space);
        CHECK(length(one - Vec3d(1, 1, 1)) < 1e-12);
        const Vec3d back = toRgb(toXyz(Vec3d(0.2, -0.3, 4), *space), *space);
        CHECK(length(back - Vec3d(0.2, -0.3, 4)) < 1e-12);
    }
    CHECK(findRgbSpace("ACEScg")->name == "lin_ap1_scene");
    CHECK_FALSE(findRgbSpace("adobe-something"));
}

TEST_CASE("the sRGB transfer function") {
    CHECK(srgbToLinear(0.5) == doctest::Approx(0.21404114).epsilon(1e-7));
    CHECK(linearToSrgb(0.18) == doctest::Approx(0.46135612).epsilon(1e-6));
    CHECK(srgbToLinear(1) == 1);
    CHECK(srgbToLinear(0) == 0);
    for (double x = -1; x <= 2; x += 0.001) REQUIRE(linearToSrgb(srgbToLinear(x)) == doctest::Approx(x).epsilon(1e-6));
}

TEST_CASE("chromatic adaptation takes white to white and has Lindbloom's Bradford matrix") {
    const Xyz d65{0.95047, 1, 1.08883}, d50{0.96422, 1, 0.82521};
    for (const ConeModel model : {ConeModel::bradford, ConeModel::cat02}) {
        const Xyz adapted = adaptation(d65, d50, model).apply<Xyz>(d65);
        CHECK(adapted.x == doctest::Approx(d50.x).epsilon(1e-12));
        CHECK(adapted.y == doctest::Approx(d50.y).epsilon(1e-12));
        CHECK(adapted.z == doctest::Approx(d50.z).epsilon(1e-12));
    }
    checkMatrix(
        adaptation(d65, d50),
        {{1.0478112, 0.0228866, -0.0501270}, {0.0295424, 0.9904844, -0.0170491}, {-0.0092345, 0.0150436, 0.7521316}},
        1e-5);
}

TEST_CASE("CIELAB") {
    const Xyz d65{0.95047, 1, 1.08883};
    const Lab white = toLab(d65, d65);
    CHECK(white.l == doctest::Approx(100));
    CHECK(std::abs(white.a) + std::abs(white.b) < 1e-10);
    CHECK(toLab(Xyz{}, d65).l == doctest::Approx(0));
    const Lab red = toLab(toXyz(Vec3d(1, 0, 0), rgb::rec709), d65);
    CHECK(red.l == doctest::Approx(53.24).epsilon(1e-3));
    CHECK(red.a == doctest::Approx(80.09).epsilon(1e-3));
    CHECK(red.b == doctest::Approx(67.20).epsilon(1e-3));
}

TEST_CASE("CIEDE2000 reproduces the pairs of Sharma, Wu and Dalal 2005, table 1") {
    struct Pair {
        Lab p, q;
        double deltaE;
    };
    const Pair pairs[] = {
        {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
        {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
        {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
        {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
        {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
        {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
        {{50, 0, 0}, {50, -1, 2}, 2.3669},
        {{50, -1, 2}, {50, 0, 0}, 2.3669},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0010}, 7.1792},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0012}, 7.2195},
        {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
        {{50, -0.0010, 2.4900}, {50, 0.0010, -2.4900}, 4.8045},
        {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
        {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
        {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
        {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
        {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
        {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
        {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1.0000},
        {{50, 2.5, 0}, {50, 3.2972, 0}, 1.0000},
        {{50, 2.5, 0}, {50, 1.8634, 0.5757}, 1.0000},
        {{50, 2.5, 0}, {50, 3.2592, 0.3350}, 1.0000},
        {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
        {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
        {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
        {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
        {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
        {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
        {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
        {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
        {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
        {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
    };
    for (const Pair& pair : pairs) {
        CHECK(std::abs(deltaE2000(pair.p, pair.q) - pair.deltaE) < 6e-5);
        CHECK(std::abs(deltaE2000(pair.q, pair.p) - pair.deltaE) < 6e-5);
    }
    CHECK(deltaE76({50, 3, 0}, {50, 0, 4}) == 5);
}

#include "io/color_difference.h"

#include <doctest/doctest.h>
#include <random>

using namespace abbe;

namespace {

RgbImage constant(int width, int height, const Vec3d& value) {
    RgbImage image;
    image.window = image.display = {0, 0, width, height};
    for (std::size_t i = 0; i < image.window.area(); ++i)
        for (const double v : {value.x, value.y, value.z}) image.rgb.push_back(static_cast<float>(v));
    return image;
}

} // namespace

// [Sharma2005, table 1]: pairs chosen so that every branch and every discontinuity of the formula matters.
TEST_CASE("CIEDE2000 of the published pairs") {
    struct Pair {
        Lab a, b;
        double expected;
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
    CHECK(std::size(pairs) == 34);
    for (const Pair& p : pairs) {
        CHECK(std::abs(deltaE2000(p.a, p.b) - p.expected) < 1e-4);
        CHECK(std::abs(deltaE2000(p.b, p.a) - p.expected) < 1e-4);
    }
    CHECK(deltaE2000({100, 0, 0}, {0, 0, 0}) == doctest::Approx(100));
}

TEST_CASE("Lab of white, grey and black") {
    const Xyz white = whiteXyz(rgb::rec709.white);
    CHECK(toLab(white, white).l == doctest::Approx(100));
    CHECK(toLab(white * 0.18, white).l == doctest::Approx(49.496).epsilon(1e-4));
    CHECK(std::abs(toLab(white * 0.18, white).a) < 1e-9);
    CHECK(std::abs(toLab({}, white).l) < 1e-9);
}

TEST_CASE("colour differences of images are seen from the white of their space and at one brightness") {
    // 5 % less light at the 18 % that the mean is shown as, in any space and at any exposure.
    const Xyz white = whiteXyz(rgb::rec709.white);
    const double expected = deltaE2000(toLab(white * 0.18, white), toLab(white * (0.18 * 0.95), white));
    for (const double level : {0.01, 3.0, 1e5}) {
        RgbImage reference = constant(16, 16, {level, level, level});
        RgbImage image = constant(16, 16, {0.95 * level, 0.95 * level, 0.95 * level});
        CHECK(colorDifference(image, reference).mean == doctest::Approx(expected).epsilon(1e-5));
        reference.chromaticities = image.chromaticities = Chromaticities::of(rgb::ap0);
        const ColorDifference d = colorDifference(image, reference);
        CHECK(d.mean == doctest::Approx(expected).epsilon(1e-5));
        CHECK(d.percentile95 == doctest::Approx(expected).epsilon(1e-5));
        CHECK(d.tileMean == doctest::Approx(expected).epsilon(1e-5));
        CHECK(colorDifference(reference, reference).mean == 0);
    }
}

TEST_CASE("means of tiles show a fault of colour that noise hides in the pixels") {
    std::mt19937 random(1);
    std::normal_distribution<double> normal(1, 0.15);
    RgbImage a = constant(128, 128, {0.3, 0.3, 0.3}), b = constant(128, 128, {0.306, 0.3, 0.294});
    for (float& v : a.rgb) v *= static_cast<float>(normal(random));
    const double noiseAlone = colorDifference(a, constant(128, 128, {0.3, 0.3, 0.3})).tileMean;
    for (float& v : b.rgb) v *= static_cast<float>(normal(random));
    const ColorDifference d = colorDifference(b, a);
    CHECK(d.mean > 5);
    CHECK(d.percentile95 > d.mean);
    CHECK(d.tileMean < d.mean / 3);
    CHECK(d.tileMean > 1.5 * noiseAlone);
}

TEST_CASE("light beyond white counts as white of its colour") {
    RgbImage reference = constant(8, 16, {0.18, 0.18, 0.18});
    RgbImage image = reference;
    for (int c = 0; c < 3; ++c)
        reference.rgb[static_cast<std::size_t>(c)] = 1000, image.rgb[static_cast<std::size_t>(c)] = 2000;
    CHECK(colorDifference(image, reference).mean == doctest::Approx(0));
    image.rgb[2] = 0;
    CHECK(colorDifference(image, reference).mean > 10.0 / 128);
    image.rgb[0] = image.rgb[1] = image.rgb[2] = -5;
    CHECK(colorDifference(image, reference).mean == doctest::Approx(100.0 / 128));
}

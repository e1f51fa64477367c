#include "io/color_difference.h"
#include "spectrum/lab.h"
#include "support/constant_image.h"

#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace abbe;
using abbe::test::constant;

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

TEST_CASE("X Y Z with a neutral of D65 is seen as Rec. 709 is") {
    const RgbImage reference = constant(8, 8, {0.3, 0.2, 0.1}), image = constant(8, 8, {0.28, 0.21, 0.1});
    const double expected = colorDifference(image, reference).mean;
    CHECK(expected > 2);
    const auto asXyz = [](const RgbImage& rgb) {
        RgbImage result = rgb;
        for (std::size_t i = 0; i < rgb.rgb.size(); i += 3) {
            const Xyz c = toXyz(Vec3d{rgb.rgb[i], rgb.rgb[i + 1], rgb.rgb[i + 2]}, rgb::rec709);
            result.rgb[i] = static_cast<float>(c.x);
            result.rgb[i + 1] = static_cast<float>(c.y);
            result.rgb[i + 2] = static_cast<float>(c.z);
        }
        result.chromaticities = Chromaticities{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};
        result.adoptedNeutral = rgb::rec709.white;
        return result;
    };
    CHECK(colorDifference(asXyz(image), asXyz(reference)).mean == doctest::Approx(expected).epsilon(1e-4));
    RgbImage tinted = asXyz(reference), other = asXyz(image);
    tinted.adoptedNeutral = other.adoptedNeutral = std::nullopt;
    CHECK(std::abs(colorDifference(other, tinted).mean - expected) > 0.01);
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

#include "io/flip.h"
#include "support/constant_image.h"

#include <cmath>
#include <doctest/doctest.h>
#include <numeric>

using namespace abbe;
using abbe::test::constant;

namespace {

// Slopes, textures and a chequerboard, in numbers that are exact in any precision.
RgbImage pattern() {
    RgbImage image = constant(56, 40, {});
    std::size_t i = 0;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 56; ++x) {
            image.rgb[i++] = static_cast<float>((7 * x + 13 * y) % 32) / 32;
            image.rgb[i++] = static_cast<float>(x * y % 64) / 64;
            image.rgb[i++] = static_cast<float>((x / 8 + y / 8) % 2) * 0.5f + 0.25f;
        }
    return image;
}

// The same with a patch of something else and less red.
RgbImage changed() {
    RgbImage image = pattern();
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 56; ++x) {
            float* rgb = &image.rgb[static_cast<std::size_t>(3 * (56 * y + x))];
            if (y >= 10 && y < 20 && x >= 20 && x < 36) {
                rgb[0] = static_cast<float>(x) / 64;
                rgb[1] = static_cast<float>(y) / 64;
                rgb[2] = static_cast<float>((x + y) % 16) / 16;
            }
            rgb[0] *= 0.75f;
        }
    return image;
}

// Six bands from a quarter to eight times the light.
RgbImage brightened(RgbImage image) {
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 56; ++x)
            for (int c = 0; c < 3; ++c)
                image.rgb[static_cast<std::size_t>(3 * (56 * y + x) + c)] *=
                    std::exp2(static_cast<float>(x / 8 % 6 - 2));
    return image;
}

double meanOf(const std::vector<float>& map) {
    return std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());
}

doctest::Approx about(double value) { return doctest::Approx(value).epsilon(1e-4); }

} // namespace

// The numbers are from a second implementation of the papers' formulas, in double precision, with the filters as the
// papers write them: in two dimensions and not separated.
TEST_CASE("LDR-FLIP of a picture is what the formulas give") {
    const std::vector<float> map = ldrFlip(changed(), pattern(), kFlipPixelsPerDegree);
    CHECK(meanOf(map) == about(0.299498373743386));
    CHECK(map[0] == about(0.23311286034905923));
    CHECK(map[15 * 56 + 28] == about(0.7665203212659139));
    CHECK(map[39 * 56 + 55] == about(0.3320156127462142));
    CHECK(*std::max_element(map.begin(), map.end()) == about(0.9550885378525056));
    const std::vector<float> far = ldrFlip(changed(), pattern(), 20);
    CHECK(meanOf(far) == about(0.3047716965509695));
    CHECK(far[15 * 56 + 28] == about(0.9632275542000036));
}

TEST_CASE("HDR-FLIP of a picture is what the formulas give, exposures included") {
    const HdrFlip flip = hdrFlip(brightened(changed()), brightened(pattern()));
    CHECK(flip.startExposure == about(-1.8134132178468472));
    CHECK(flip.stopExposure == about(2.3778494502550953));
    CHECK(flip.exposures == 5);
    CHECK(flip.mean == about(0.23038044245235903));
    CHECK(flip.map[0] == about(0.19876983299568415));
    CHECK(flip.map[15 * 56 + 28] == about(0.6612342723506518));
    CHECK(*std::max_element(flip.map.begin(), flip.map.end()) == about(0.8742133064915553));
}

TEST_CASE("the filters of FLIP are those of the papers, weight by weight") {
    const FlipFilters filters(kFlipPixelsPerDegree);
    CHECK(filters.radius() == 10);
    constexpr int width = 41;
    FlipPlane impulse(width, 21 + 2 * filters.radius());
    impulse.row(10 + filters.radius())[20] = 1;
    const auto close = [](const std::vector<float>& values, int dx, int dy, double expected) {
        return std::abs(values[static_cast<std::size_t>(width * (10 + dy) + 20 + dx)] - expected) < 1e-6 * expected;
    };
    const std::vector<float> a = filters.achromatic(impulse), r = filters.redGreen(impulse);
    CHECK(close(a, 0, 0, 0.14881092959817405));
    CHECK(close(a, 1, 0, 0.09323966738242204));
    CHECK(close(a, 3, 2, 0.0003413432714894462));
    CHECK(close(r, 0, 0, 0.13196440960021213));
    CHECK(close(r, 0, 1, 0.08717816011767025));
    CHECK(close(r, 2, 3, 0.0006023074826656456));
    const std::vector<float> y = filters.blueYellow(impulse);
    CHECK(close(y, 0, 0, 0.02000057943121686));
    CHECK(close(y, 1, 0, 0.018726737222749083));
    CHECK(close(y, -3, 2, 0.008654079040295384));
    const std::vector<float> edges = filters.edges(impulse), points = filters.points(impulse);
    CHECK(close(edges, 3, 2, 0.02972793482988894));
    CHECK(close(edges, 3, 0, 0.03223659501493324));
    CHECK(close(points, 3, -2, 0.009342404805855986));
    CHECK(close(points, 0, 3, 0.02437311212612898));
}

TEST_CASE("FLIP of constant pictures is the colour difference alone") {
    const auto flip = [](const Vec3d& a, const Vec3d& b) {
        return ldrFlip(constant(32, 32, a), constant(32, 32, b), kFlipPixelsPerDegree);
    };
    CHECK(meanOf(flip({0, 0, 0}, {1, 1, 1})) == about(0.9673791822144578));
    CHECK(meanOf(flip({0.18, 0.18, 0.18}, {0.2, 0.2, 0.2})) == about(0.10436490906772365));
    // Blue and green are the pair that defines 1.
    CHECK(meanOf(flip({0, 1, 0}, {0, 0, 1})) == about(1));
    CHECK(flip({0.3, 0.2, 0.9}, {0.3, 0.2, 0.9}) == std::vector<float>(32 * 32, 0));
}

TEST_CASE("FLIP of one bright pixel") {
    const RgbImage black = constant(48, 48, {});
    RgbImage dot = black;
    for (int c = 0; c < 3; ++c) dot.rgb[static_cast<std::size_t>(3 * (48 * 24 + 24) + c)] = 1;
    const std::vector<float> map = ldrFlip(dot, black, kFlipPixelsPerDegree);
    CHECK(meanOf(map) == about(0.006211562442873427));
    CHECK(map[24 * 48 + 24] == about(0.8648986460612916));
    CHECK(map[24 * 48 + 27] == about(0.1337096784463632));
}

TEST_CASE("LDR-FLIP is symmetric and stays within 0 and 1; strips do not show") {
    const RgbImage a = pattern(), b = changed();
    CHECK(ldrFlip(a, b, 67) == ldrFlip(b, a, 67));
    for (const float v : ldrFlip(a, b, 1)) CHECK((v >= 0 && v <= 1));
    // Rows repeat down a picture of several strips, so that the result must too, away from the ends.
    RgbImage tallA = constant(16, 320, {}), tallB = tallA;
    for (std::size_t i = 0; i < tallA.rgb.size(); ++i) {
        tallA.rgb[i] = static_cast<float>(i % 48) / 48;
        tallB.rgb[i] = static_cast<float>(i % 16) / 16;
    }
    const std::vector<float> map = ldrFlip(tallA, tallB, kFlipPixelsPerDegree);
    for (std::size_t i = 16 * 12; i < map.size() - 16 * 12; ++i) CHECK(map[i] == map[i % 16 + 16 * 12]);
}

TEST_CASE("HDR-FLIP does not depend on the brightness of both, nor on the space that holds the colours") {
    const RgbImage a = brightened(changed()), b = brightened(pattern());
    RgbImage brightA = a, brightB = b;
    for (float& v : brightA.rgb) v *= 1024;
    for (float& v : brightB.rgb) v *= 1024;
    CHECK(hdrFlip(brightA, brightB).mean == about(hdrFlip(a, b).mean));
    // Grey of one space is grey of the other after adaptation.
    RgbImage acesGrey = constant(16, 16, {0.3, 0.3, 0.3}), acesLight = constant(16, 16, {0.4, 0.4, 0.4});
    const double plain = hdrFlip(acesLight, acesGrey).mean;
    acesGrey.chromaticities = acesLight.chromaticities = Chromaticities::of(rgb::ap0);
    CHECK(hdrFlip(acesLight, acesGrey).mean == about(plain));
}

TEST_CASE("HDR-FLIP of black references and mostly black ones is finite") {
    const RgbImage black = constant(16, 16, {}), grey = constant(16, 16, {0.5, 0.5, 0.5});
    CHECK(hdrFlip(black, black).mean == 0);
    CHECK(hdrFlip(grey, black).mean > 0.1);
    RgbImage light = black;
    light.rgb[30] = light.rgb[31] = light.rgb[32] = 100;
    const HdrFlip flip = hdrFlip(black, light);
    CHECK(flip.startExposure == flip.stopExposure);
    CHECK(flip.exposures == 2);
    CHECK(flip.mean > 0);
}

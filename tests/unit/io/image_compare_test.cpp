#include "io/image_compare.h"
#include "spectrum/color_space.h"
#include "support/constant_image.h"

#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <random>
#include <vector>

using namespace abbe;

namespace {

RgbImage constant(int width, int height, float value) {
    RgbImage image;
    image.window = image.display = {0, 0, width, height};
    image.rgb.assign(3 * image.window.area(), value);
    return image;
}

RgbImage noisy(const RgbImage& image, double sigma, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, sigma);
    RgbImage result = image;
    for (float& v : result.rgb) v = static_cast<float>(v + normal(random));
    return result;
}

} // namespace

TEST_CASE("figures of a known difference") {
    const RgbImage reference = constant(10, 10, 2);
    RgbImage image = reference;
    CHECK(compare(image, reference).mse == 0);
    CHECK(std::isinf(compare(image, reference).psnr));
    image.rgb[0] = 2.5f;
    const ImageDifference d = compare(image, reference);
    CHECK(d.mse == doctest::Approx(0.25 / 300));
    CHECK(d.maximum == 0.5);
    CHECK(d.psnr == doctest::Approx(10 * std::log10(4 / (0.25 / 300))));
    // Scaled to a mean of 0.25, the difference is 1/16 and r is 1/4.
    CHECK(d.relMse == doctest::Approx(1.0 / 256 / (0.0625 + 0.01) / 300));
    CHECK(d.meanRatio == doctest::Approx(1 + 0.5 / 600));
}

TEST_CASE("relMSE does not depend on the scale of the images") {
    const RgbImage reference = noisy(constant(50, 50, 1), 0.1, 1), image = noisy(reference, 0.2, 2);
    RgbImage scaledReference = reference, scaledImage = image;
    for (float& v : scaledReference.rgb) v *= 1024;
    for (float& v : scaledImage.rgb) v *= 1024;
    CHECK(compare(scaledImage, scaledReference).relMse == doctest::Approx(compare(image, reference).relMse));
}

TEST_CASE("the tail is what few pixels add") {
    const RgbImage reference = constant(100, 100, 1);
    RgbImage image = noisy(reference, 0.01, 3);
    const double quiet = compare(image, reference).relMse;
    image.rgb[3000] = 1000;
    const ImageDifference d = compare(image, reference);
    CHECK(d.relMse > 100 * quiet);
    CHECK(d.relMseWithoutTail == doctest::Approx(quiet).epsilon(0.05));
}

TEST_CASE("the noise of two references cancels") {
    const RgbImage truth = constant(200, 200, 0.25f);
    const RgbImage image = noisy(truth, 0.01, 4), a = noisy(truth, 0.05, 5), b = noisy(truth, 0.05, 6);
    const double exact = 1e-4 / (0.0625 + 0.01);
    CHECK(unbiasedRelMse(image, a, b) == doctest::Approx(exact).epsilon(0.1));
    CHECK(compare(image, a).relMse > 10 * exact);
}

TEST_CASE("images that do not match are refused; bad pixels are counted") {
    const RgbImage reference = constant(4, 4, 1);
    CHECK(!comparisonFault(reference, reference));
    CHECK(comparisonFault(constant(4, 5, 1), reference));
    RgbImage image = reference;
    image.window = {1, 0, 5, 4};
    CHECK(comparisonFault(image, reference));
    RgbImage ap0 = reference, ap1 = reference;
    ap0.chromaticities = Chromaticities::of(rgb::ap0);
    ap1.chromaticities = Chromaticities::of(rgb::ap1);
    CHECK(comparisonFault(ap0, ap1));
    CHECK(!comparisonFault(ap0, reference));
    image = reference;
    image.rgb[4] = std::numeric_limits<float>::quiet_NaN();
    image.rgb[11] = std::numeric_limits<float>::infinity();
    CHECK(compare(image, reference).nonFinite == 2);
    CHECK(std::isnan(compare(image, reference).relMse));
}

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

using namespace abbe;

namespace {

constexpr int kTestedWidth = 256, kTestedHeight = 192;
constexpr double kFloat = 0x1p-22;

// A rendered image: the mean and the variance of the mean of R replicates, whose distribution and noise vary over it.
struct Render {
    std::vector<float> values, variances;
    int replicates;

    Render(unsigned seed, int r, double bias = 1, bool skewed = false) : replicates(r) {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        for (int i = 0; i < kTestedWidth * kTestedHeight; ++i) {
            const double level = 0.2 + (i % kTestedWidth) / 300.0,
                         sigma = 0.05 + 0.2 * (i / kTestedWidth) / kTestedHeight;
            double sum = 0, squares = 0;
            for (int k = 0; k < r; ++k) {
                const double z = normal(random);
                const double x = level * bias * (1 + sigma * (skewed ? (std::exp(z) - std::exp(0.5)) / 2.1612 : z));
                sum += x;
                squares += x * x;
            }
            values.push_back(static_cast<float>(sum / r));
            variances.push_back(static_cast<float>(std::max(0.0, squares - sum * sum / r) / (r - 1) / r));
        }
    }
    NoisyPlane plane() const { return {values, variances, replicates, kFloat}; }
};

TileTest tested(const Render& a, const Render& b) {
    return tileTest(a.plane(), b.plane(), kTestedWidth, kTestedHeight);
}

} // namespace

TEST_CASE("scores of images that agree are normal") {
    for (const int replicates : {2, 8}) {
        const TileTest t = tested(Render(1, replicates), Render(2, replicates));
        CHECK(t.tiles == kTestedWidth * kTestedHeight / 64);
        CHECK(std::abs(t.mean) < 0.12);
        CHECK(std::abs(t.deviation - 1) < 0.08); // three standard errors
        CHECK(t.probability() > 0.01);
        CHECK(t.verdict() == "the images agree within their noise");
    }
}

TEST_CASE("a bias of 1 % is found, over the image and in one tile") {
    const TileTest all = tested(Render(3, 4, 1.01), Render(4, 4));
    CHECK(all.probability() < 1e-6);
    CHECK(all.verdict().find("brighter") != std::string::npos);
    CHECK(tested(Render(5, 4, 0.99), Render(6, 4)).verdict().find("darker") != std::string::npos);

    Render local(7, 4);
    for (int y = 40; y < 48; ++y)
        for (int x = 80; x < 88; ++x) local.values[static_cast<std::size_t>(y * kTestedWidth + x)] *= 1.1f;
    const TileTest one = tested(local, Render(8, 4));
    CHECK(one.largestProbability < 0.01);
    CHECK(one.largestX == 80);
    CHECK(one.largestY == 40);
    CHECK(one.verdict().find("(80, 40)") != std::string::npos);
}

TEST_CASE("variances that are wrong, and seeds in common, are found") {
    Render a(9, 4);
    for (float& v : a.variances) v *= 2;
    CHECK(tested(a, Render(10, 4)).kolmogorovProbability < 0.01);
    const Render same(11, 4);
    CHECK(tested(same, same).verdict() == "the images are equal, noise included");
    CHECK(tested(same, same).probability() < 1e-6);
}

TEST_CASE("tiles without noise are compared up to rounding; what is not finite is left out") {
    std::vector<float> values(64 * 4, 0.5f), none(64 * 4, 0.0f), noise(64 * 4, 1e-4f);
    const NoisyPlane exact{values, none, 2, kFloat};
    CHECK(tileTest(exact, exact, 32, 8).noiseless == 4);
    CHECK(tileTest(exact, exact, 32, 8).verdict() == "the images are equal; there is no noise");
    std::vector<float> other = values;
    other[3] = 0.5001f;
    const TileTest t = tileTest(exact, {other, none, 2, kFloat}, 32, 8);
    CHECK(t.unequal == 1);
    CHECK(t.probability() == 0);
    CHECK(tileTest(exact, {other, none, 2, 0x1p-11}, 32, 8).unequal == 0);

    noise[0] = std::numeric_limits<float>::infinity();
    other[9] = std::numeric_limits<float>::quiet_NaN();
    const TileTest s = tileTest({values, noise, 2, kFloat}, {other, noise, 2, kFloat}, 32, 8);
    CHECK(s.skipped == 2);
    CHECK(s.tiles == 2);
    const NoisyPlane unknown{std::span(values).first(64), std::span(noise).first(64), 2, kFloat};
    CHECK(tileTest(unknown, unknown, 8, 8).verdict().find("nothing") == 0);
}

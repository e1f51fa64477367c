#include "io/image_compare.h"

#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <random>

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

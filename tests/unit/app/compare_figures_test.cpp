#include "commands/command_table.h"
#include "pictures/compare_figures.h"

#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <set>

using namespace abbe;

namespace {

CompareImage grey(float value, float variance) {
    CompareImage image;
    image.path = "grey";
    image.picture.window = image.picture.display = {0, 0, 16, 16};
    image.picture.rgb.assign(3 * 256, value);
    image.variance.assign(256, variance);
    image.replicates = 4;
    image.rounding = 0x1p-22;
    return image;
}

CompareFigures measure(const CompareImage& image, const CompareImage& reference) {
    return CompareFigures::measure(image, {&reference, 1}, reference, kFlipPixelsPerDegree);
}

} // namespace

TEST_CASE("every figure has a name of its own and is found by it") {
    std::set<std::string> names;
    for (const CompareFigure& figure : compareFigures()) {
        CHECK(names.insert(figure.name).second);
        CHECK(findCompareFigure(figure.name) == &figure);
    }
    CHECK_FALSE(findCompareFigure("flop"));
}

TEST_CASE("equal images are within every bound, and a bound is a bound") {
    const CompareFigures equal = measure(grey(0.5f, 0), grey(0.5f, 0));
    for (const CompareFigure& figure : compareFigures()) CHECK(figure.within(equal, figure.atLeast ? 1 : 0));
    const CompareFigures other = measure(grey(0.6f, 0), grey(0.5f, 0));
    const double mse = other.difference.mse;
    CHECK(findCompareFigure("mse")->within(other, mse));
    CHECK_FALSE(findCompareFigure("mse")->within(other, 0.999 * mse));
    CHECK(findCompareFigure("psnr")->within(other, 13));
    CHECK_FALSE(findCompareFigure("psnr")->within(other, 15)); // 20 log₁₀ 5 = 13.98
    CHECK(findCompareFigure("agreement")->value(other) == 0);
    CHECK(findCompareFigure("mean-error")->value(other) == doctest::Approx(0.2));
}

TEST_CASE("what cannot be told is within no bound") {
    CompareImage broken = grey(0.5f, 0.01f);
    broken.picture.rgb[7] = std::numeric_limits<float>::quiet_NaN();
    broken.variance.clear();
    const CompareFigures figures = measure(broken, grey(0.5f, 0.01f));
    for (const CompareFigure& figure : compareFigures()) {
        if (figure.name == std::string_view("non-finite")) continue;
        CHECK(std::isnan(figure.value(figures)));
        CHECK_FALSE(figure.within(figures, figure.atLeast ? 0 : 1e300));
        CHECK(figure.text(figures) == "–");
    }
    CHECK(findCompareFigure("non-finite")->value(figures) == 1);
}

TEST_CASE("the mean of references has their mean variance divided by their number") {
    const CompareImage both[] = {grey(0.4f, 0.01f), grey(0.6f, 0.03f)};
    const CompareImage mean = CompareImage::mean(both);
    CHECK(mean.picture.rgb[5] == doctest::Approx(0.5));
    CHECK(mean.variance[5] == doctest::Approx(0.01));
    CHECK(mean.luminance()[5] == doctest::Approx(0.5));
    CompareImage blind = both[1];
    blind.variance.clear();
    const CompareImage mixed[] = {both[0], blind};
    CHECK(CompareImage::mean(mixed).variance.empty());
}

TEST_CASE("thresholds on the command line") {
    const auto threshold = [](const char* text) { return std::get<CompareThreshold>(readThreshold(text)); };
    CHECK(threshold("0.01").figure == "relmse");
    CHECK(threshold("0.01").value == 0.01);
    CHECK(threshold("flip=5e-2").figure == "flip");
    CHECK(threshold("flip=5e-2").value == 0.05);
    for (const char* text :
         {"", "flip", "flip=", "flip=1x", "flip=-1", "=1", "flop=1", "flip=nan", "flip=inf", "FLIP=1"})
        CHECK(std::holds_alternative<std::string>(readThreshold(text)));
}

#include "pictures/image_output.h"
#include "pictures/picture_figures.h"
#include "rendering/path_tracer.h"
#include "reports/render_text.h"
#include "reports/render_warnings.h"
#include "support/scene_test.h"

#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <vector>

using namespace abbe;

namespace {

constexpr double kNitsOfPixel = 72983.27; // of Y = 1
constexpr int kSide = 10;

// Of a grey picture with these luminances, by pixel, in the default view.
struct GreyPicture {
    explicit GreyPicture(const std::function<double(int)>& y, double exposure = 1, double viewStops = 0)
        : film({0, 0, kSide, kSide}, PixelFilter(FilterShape::box, 0.5), 1) {
        const Xyz white = whiteXyz(rgb::ap0.white);
        for (int i = 0; i < kSide * kSide; ++i) {
            ExactXyz sum;
            sum += white * (y(i) / white.y);
            film.add(i % kSide, i / kSide, 0, sum, 1);
        }
        const FilmSettings settings;
        const ResolvedImage image = resolveImage(film, settings, exposure);
        const DisplayView view(settings.space, {{}, {}, OcioView::builtInConfig, viewStops});
        figures = figuresOf({film, image, {0, 0, kSide, kSide}, exposure, &view, viewStops});
    }
    PixelFilm film;
    PictureFigures figures;
};

PictureFigures figuresOfGrey(const std::function<double(int)>& y, double exposure = 1, double viewStops = 0) {
    return GreyPicture(y, exposure, viewStops).figures;
}

Diagnostics warningsOf(const PictureFigures& figures, const ShownStops& stops) {
    Diagnostics diagnostics;
    warnOfDisplay(figures, stops, {}, diagnostics);
    return diagnostics;
}

} // namespace

TEST_CASE("key figures are of the light, not of the exposure") {
    for (const double exposure : {1.0, 1e-3}) {
        const PictureFigures f = figuresOfGrey([](int i) { return (i + 1) / 100.0; }, exposure);
        CHECK(f.median == doctest::Approx(0.50 * kNitsOfPixel).epsilon(1e-5));
        CHECK(f.high == doctest::Approx(0.99 * kNitsOfPixel).epsilon(1e-5));
    }
}

TEST_CASE("shares of the display: a quarter black, a tenth white") {
    const PictureFigures f = figuresOfGrey([](int i) { return i < 25 ? 1e-5 : i < 35 ? 1e3 : 0.18; });
    REQUIRE(f.display);
    CHECK(f.display->black == 0.25);
    CHECK(f.display->white == 0.10);
    CHECK_FALSE(f.missingStops);
    CHECK(pictureLine(f) == "picture median 1.31e+04 nits, 99 % of it up to 7.3e+07 nits   display 25.0 % below 1 %, "
                            "10.0 % above 99 %");
}

TEST_CASE("a picture that shows nothing names the stops that show it") {
    const PictureFigures dark = figuresOfGrey([](int) { return 0.18 / 1024; });
    CHECK(dark.display->black == 1);
    CHECK(dark.missingStops == 10);
    CHECK_FALSE(figuresOfGrey([](int) { return 0.18 / 1024; }, 1024).missingStops);  // exposed so
    CHECK_FALSE(figuresOfGrey([](int) { return 0.18 / 1024; }, 1, 10).missingStops); // viewed so
    const PictureFigures bright = figuresOfGrey([](int) { return 0.18 * 4096; });
    CHECK(bright.display->white == 1);
    CHECK(bright.missingStops == -12);
}

TEST_CASE("what receives no light at all is no fault of the exposure") {
    const auto spot = [](double y) { return figuresOfGrey([y](int i) { return i < 3 ? y : 0.0; }); };
    CHECK_FALSE(spot(0.18).missingStops);
    CHECK(spot(0.18 / 4096).missingStops == 12);
    CHECK_FALSE(spot(0).missingStops);
}

TEST_CASE("a low-key and a high-key picture are meant so") {
    CHECK_FALSE(figuresOfGrey([](int i) { return i < 90 ? 1e-4 : 0.5; }).missingStops);
    CHECK_FALSE(figuresOfGrey([](int i) { return i < 90 ? 1e3 : 0.5; }).missingStops);
}

TEST_CASE("the warning adds the stops to those of the camera and of the view") {
    CHECK(warningsOf(figuresOfGrey([](int) { return 0.18; }), {}).all().empty());
    const Diagnostics dark = warningsOf(figuresOfGrey([](int) { return 0.18 / 1024; }), {-1.5, 0, "a b.exr"});
    REQUIRE(dark.all().size() == 1);
    CHECK(dark.all()[0].code == "W0644");
    CHECK(dark.all()[0].message == "100 % of the picture is black on the display");
    CHECK(dark.all()[0].help.find("`exposure 8.5 stops`") != std::string::npos);
    CHECK(dark.all()[0].help.find("`abbe convert 'a b.exr' 'a b.png' --exposure 10.0`") != std::string::npos);
    const Diagnostics bright = warningsOf(figuresOfGrey([](int) { return 0.18 * 1024; }), {3, 0, "a.exr"});
    REQUIRE(bright.all().size() == 1);
    CHECK(bright.all()[0].message.find("white") != std::string::npos);
    CHECK(bright.all()[0].help.find("`exposure -7.0 stops`") != std::string::npos);
}

namespace {

constexpr double kNitsOfUnit = 72983.27; // of Y = 1

std::optional<double> metered(const std::string& text, double sensitivity = 1) {
    const auto scene = test::TestScene::parse("scene 1\n" + text + "\n");
    REQUIRE(scene.report() == "");
    return meterExposure(scene.scene(), *makePathTracer(scene.scene().effects), 0, sensitivity);
}

std::optional<double> stopsOf(std::vector<float> luminances) { return stopsForMiddleGrey(luminances); }

} // namespace

TEST_CASE("the geometric mean of a picture becomes middle grey") {
    CHECK(stopsOf({0.18f}) == 0);
    CHECK(stopsOf({8 * 0.18f, 8 * 0.18f}) == -3);
    CHECK(stopsOf({0.18f / 4, 0.18f / 16}) == 3);
    CHECK(stopsOf({0.2f}) == doctest::Approx(-0.2)); // −0.15, in tenths
    CHECK_FALSE(stopsOf({}));
    CHECK_FALSE(stopsOf({0, 0, -1, std::nanf("")}));
}

TEST_CASE("night around a picture is not metered, and neither are pixels without light") {
    std::vector<float> picture(100, 0.18f);
    picture.resize(150, 1e-5f);
    CHECK(stopsForMiddleGrey(picture) == 0);
    picture.resize(1000, 0.f);
    CHECK(stopsForMiddleGrey(picture) == 0);
    CHECK(stopsOf({0.18f, 0.18f, 0.18f * 0.002f}) == doctest::Approx(3.0)); // a thousandth is the bound: log2(500)/3
}

TEST_CASE("a scene of even radiance is metered exactly, whatever its size and its seed") {
    const double expected = std::round(10 * std::log2(0.18 * kNitsOfUnit / 1000)) / 10; // 3.7
    for (const char* size : {"64 48", "1 1", "5 300", "4000 3000"})
        for (const char* seed : {"0", "7"})
            CHECK(metered("film { size " + std::string(size) + " }\nrender { seed " + seed +
                          " }\ncamera { from 0 0 5; look-at 0 0 0; exposure auto }\nlight sky { luminance 1000 nits }"
                          "\nshape sphere { radius 0.5; material diffuse { reflectance 1 } }") ==
                  doctest::Approx(expected));
}

TEST_CASE("stops count from what the sensor makes of the light") {
    const std::string scene =
        "film { size 32 32 }\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { luminance 1000 nits }";
    CHECK(*metered(scene, 4) == doctest::Approx(*metered(scene) - 2));
}

TEST_CASE("a look that finds no light says so") {
    CHECK_FALSE(metered("film { size 16 16 }\ncamera { from 0 0 5; look-at 0 0 9 }\n"
                        "light quad { size 1 1 m; luminance 9 nits }"));
}

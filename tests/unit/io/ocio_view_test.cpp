#include "io/data/ocio_config.h"
#include "io/file.h"
#include "io/ocio_view.h"
#include "spectrum/color_space.h"
#include "temporary_folder.h"

#include <array>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

std::array<float, 3> shown(const OcioView& view, float r, float g, float b) {
    std::array<float, 3> rgb{r, g, b};
    view.apply(rgb);
    return rgb;
}

void checkGrey(const OcioView& view, float in, double out) {
    for (const float c : shown(view, in, in, in)) CHECK(c == doctest::Approx(out).epsilon(1e-4));
}

} // namespace

TEST_CASE("the default view has the figures of the ACES 1.0 SDR video transform") {
    const OcioView view(ViewInput::acescg);
    checkGrey(view, 0.18f, 0.35595);
    checkGrey(view, 1, 0.81197);
    checkGrey(view, 10, 0.99058);
    const auto red = shown(view, 1, 0, 0), green = shown(view, 0, 1, 0), blue = shown(view, 0, 0, 1);
    CHECK(red[0] == doctest::Approx(0.9594).epsilon(1e-3));
    CHECK(red[1] == doctest::Approx(-0.716).epsilon(2e-3)); // not clamped
    CHECK(green[0] == doctest::Approx(-4.194).epsilon(1e-3));
    CHECK(blue[2] == doctest::Approx(0.852).epsilon(1e-3));
    CHECK(view.isSrgb());
}

TEST_CASE("a configuration has a name and a digest that change with it") {
    const OcioIdentity builtIn = OcioView::identify();
    CHECK(builtIn.name == OcioView::builtInConfig);
    CHECK(builtIn.hash.size() >= 32);
    const OcioView view(ViewInput::acescg);
    CHECK(view.config().hash == builtIn.hash);
    const TemporaryFolder folder;
    writeAll(folder / "same.ocio", kOcioConfig);
    CHECK(OcioView::identify(folder / "same.ocio").hash == builtIn.hash);
    std::string text = kOcioConfig;
    text.replace(text.find("0.0722"), 6, "0.0721");
    writeAll(folder / "other.ocio", text);
    CHECK(OcioView::identify(folder / "other.ocio").hash != builtIn.hash);
    text.erase(text.find("name: abbe-aces-1.3"), sizeof "name: abbe-aces-1.3");
    writeAll(folder / "nameless.ocio", text);
    CHECK(OcioView::identify(folder / "nameless.ocio").name == "nameless.ocio");
    CHECK_THROWS_AS(OcioView::identify(folder / "absent.ocio"), IoError);
    text = kOcioConfig;
    for (std::size_t at; (at = text.find(" ACEScg\n")) != std::string::npos;) text.replace(at, 7, " Linear");
    writeAll(folder / "no_acescg.ocio", text);
    CHECK_THROWS_WITH_AS(
        OcioView(ViewInput::acescg, OcioView::defaultDisplay, OcioView::defaultView, folder / "no_acescg.ocio"),
        doctest::Contains("no colour space ACEScg"), IoError);
}

TEST_CASE("views for other displays") {
    checkGrey(OcioView{ViewInput::acescg, "sRGB - Display", "Un-tone-mapped"}, 0.18f, 0.46136);
    checkGrey(OcioView{ViewInput::acescg, "sRGB - Display", "Un-tone-mapped"}, 1, 1);
    checkGrey(OcioView{ViewInput::acescg, "Rec.1886 Rec.709 - Display"}, 0.18f, 0.38953);
    checkGrey(OcioView{ViewInput::acescg, "P3-D65 - Display"}, 0.18f, 0.41883);
    const OcioView pq(ViewInput::acescg, "Rec.2100-PQ - Display", "ACES 1.1 - HDR Video (1000 nits & Rec.2020 lim)");
    checkGrey(pq, 0.18f, 0.33259);
    checkGrey(pq, 1, 0.5153);
    checkGrey(pq, 10, 0.68009);
    CHECK(!pq.isSrgb());
    const OcioView raw(ViewInput::acescg, "sRGB - Display", "Raw");
    checkGrey(raw, 0.18f, 0.18);
    CHECK(!raw.isSrgb());
}

TEST_CASE("AP0 and AP1 of one colour look the same") {
    const OcioView ap0(ViewInput::aces2065_1), ap1(ViewInput::acescg);
    const Xyz colour{0.3, 0.25, 0.1};
    const Vec3d a = toRgb(colour, rgb::ap0), b = toRgb(colour, rgb::ap1);
    const auto f = [](double v) { return static_cast<float>(v); };
    const auto x = shown(ap0, f(a.x), f(a.y), f(a.z)), y = shown(ap1, f(b.x), f(b.y), f(b.z));
    for (std::size_t i = 0; i < 3; ++i) CHECK(x[i] == doctest::Approx(y[i]).epsilon(1e-4));
}

TEST_CASE("every listed view works, unknown ones name the known") {
    const auto all = OcioView::list();
    CHECK(all.size() == 4);
    CHECK(all.front().display == OcioView::defaultDisplay);
    CHECK(all.front().views.front() == OcioView::defaultView);
    for (const DisplayViews& d : all)
        for (const std::string& v : d.views)
            CHECK(shown(OcioView{ViewInput::acescg, d.display, v}, 0.2f, 0.2f, 0.2f)[0] > 0.1f);
    CHECK_THROWS_WITH_AS(OcioView(ViewInput::acescg, "Projector"), doctest::Contains("`P3-D65 - Display`"), IoError);
    CHECK_THROWS_WITH_AS(OcioView(ViewInput::acescg, "sRGB - Display", "Filmic"),
                         doctest::Contains("`ACES 1.0 - SDR Video`"), IoError);
}

TEST_CASE("other configurations come from a file") {
    const TemporaryFolder folder;
    writeAll(folder / "config.ocio", kOcioConfig);
    checkGrey(OcioView{ViewInput::acescg, OcioView::defaultDisplay, OcioView::defaultView, folder / "config.ocio"},
              0.18f, 0.35595);
    CHECK_THROWS_AS(OcioView::list(folder / "absent.ocio"), IoError);
    writeAll(folder / "bad.ocio", "nothing");
    CHECK_THROWS_AS(OcioView::list(folder / "bad.ocio"), IoError);
}

TEST_CASE("large pictures are converted like single pixels") {
    const OcioView view(ViewInput::acescg);
    std::vector<float> picture(3 * 100'000, 0.18f);
    view.apply(picture);
    const float one = shown(view, 0.18f, 0.18f, 0.18f)[0];
    for (std::size_t i = 0; i < picture.size(); i += 3) REQUIRE(picture[i] == one);
}

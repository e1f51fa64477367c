// Shapes that only some rays see: what is asked for and what is scattered agree on where light arrives, and rays that
// see everything render what they always did.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

using Weights = Technique::Weights;

// A satin floor and a rough ball under a light that is large, near and out of the picture; scattering finds much of it.
TestScene hiddenStage(const std::string& more, const std::string& light = "") {
    return TestScene::parse(
        "scene 1\nfilm { size 32 24; filter box 0.5 }\nrender { max-depth 6; roulette off }\n"
        "camera { from 0 1.6 4; look-at 0 0.5 0; fov 38 deg }\n"
        "light key quad { points -1.2 2.4 -1  1.2 2.4 -1  1.2 2.4 1  -1.2 2.4 1; luminance 900 nits; " +
        light +
        " }\n"
        "light sky { luminance 60 nits; color rgb 0.3 0.5 1 }\n"
        "shape floor quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material conductor { index metal Al; roughness 0.5 "
        "} }\n"
        "shape ball sphere { center 0.7 0.5 0; radius 0.5; material diffuse { reflectance 0.6 } }\n" +
        more + "\n");
}

TestImage renderWeighed(const TestScene& scene, Weights weights, std::uint32_t samples, std::uint64_t seed) {
    RenderSettings settings = scene.settings();
    settings.samples = samples;
    settings.seed = seed;
    settings.technique.weights = weights;
    return render(scene, settings);
}

// Light that both techniques find: by both of them, by scattering alone and by next-event estimation alone.
void techniquesAgree(const TestScene& scene, double error) {
    const std::uint32_t samples = nightly() ? 4096 : 256;
    if (!nightly()) error *= 1.5;
    const TestImage both = renderWeighed(scene, Weights::balance, samples, 1);
    checkSame(compareImages(renderWeighed(scene, Weights::lights, samples, 2).film, both.film), error);
    checkSame(compareImages(renderWeighed(scene, Weights::scattering, samples, 3).film, both.film), error);
}

int differingPixels(const TestScene& a, const TestScene& b, PixelBounds within) {
    const TestImage x = render(a, 16), y = render(b, 16);
    int count = 0;
    for (int j = within.y0; j < within.y1; ++j)
        for (int i = within.x0; i < within.x1; ++i)
            count += !(x.film.pixel(i, j, Channel::y).mean == y.film.pixel(i, j, Channel::y).mean);
    return count;
}
constexpr PixelBounds kWholePicture{0, 0, 32, 24};

std::string cardSeenBy(const std::string& visible) {
    return fmt::format("shape card quad {{ points -1 1.3 -0.6  0.2 1.3 -0.6  0.2 1.3 0.6  -1 1.3 0.6; {} material "
                       "diffuse {{ reflectance 0.3 }} }}",
                       visible.empty() ? "" : "visible-to " + visible + ";");
}

} // namespace

TEST_CASE("shapes that shadows and reflections see differently: scattering and next-event estimation come to the same "
          "light") {
    for (const std::string visible :
         {"camera reflections", "shadows", "camera shadows", "reflections", "camera", "none"}) {
        CAPTURE(visible);
        techniquesAgree(hiddenStage(cardSeenBy(visible)), 0.01);
    }
}

TEST_CASE("lights that reflections or shadows do not see light the scene all the same") {
    for (const std::string visible : {"camera", "shadows", "none", "camera shadows", "reflections"}) {
        CAPTURE(visible);
        techniquesAgree(hiddenStage(cardSeenBy(""), fmt::format("visible-to {}", visible)), 0.01);
    }
}

TEST_CASE("hidden shapes in fog, between places in it and a light") {
    for (const std::string visible : {"camera reflections", "shadows"}) {
        CAPTURE(visible);
        techniquesAgree(hiddenStage(cardSeenBy(visible) +
                                    "\nvolume air atmosphere { extinction 0.3 per-m; albedo 0.8; scale-height 3 m }"),
                        0.01);
    }
}

TEST_CASE("behind a boundary and in front of openings hidden shapes count as everywhere") {
    const std::string box = "shape box { min -1.3 0.05 -0.9; max 0.3 1.1 0.9; material boundary; interior homogeneous "
                            "{ extinction 0.5 per-m; albedo 0.9 } }\n",
                      holes =
                          "shape net quad { points -1.2 1.2 -1  1.2 1.2 -1  1.2 1.2 1  -1.2 1.2 1; material diffuse "
                          "{ opacity 0.6 } }\n";
    for (const std::string visible : {"camera reflections", "shadows"}) {
        CAPTURE(visible);
        techniquesAgree(hiddenStage(cardSeenBy(visible) + "\n" + box + holes), 0.012);
    }
}

TEST_CASE("a light out of the picture may be hidden from the camera: the same bits") {
    CHECK(differingPixels(hiddenStage(cardSeenBy("")), hiddenStage(cardSeenBy(""), "visible-to shadows reflections"),
                          kWholePicture) == 0);
}

TEST_CASE("a sky hidden from the camera is black behind the scene, and lights it to the last bit") {
    const std::string text =
        "scene 1\nfilm { size 32 24; filter box 0.5 }\ncamera { from 0 0 4; look-at 0 0 0; fov 40 deg }\n"
        "shape sphere { radius 0.5; material diffuse }\nlight sky { luminance 300 nits";
    const TestScene shown = TestScene::parse(text + " }\n"),
                    hidden = TestScene::parse(text + "; visible-to reflections }\n");
    const TestImage a = render(shown, 16), b = render(hidden, 16);
    int same = 0, black = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x) {
            const double own = a.film.pixel(x, y, Channel::y).mean, other = b.film.pixel(x, y, Channel::y).mean;
            const bool sky = (x < 4 || x >= 28);
            same += !sky && own == other;
            black += sky && own > 0 && other == 0;
        }
    CHECK(black == 8 * 24);
    CHECK(same > 70); // the ball
}

TEST_CASE("what the camera alone sees shades nothing, and is not mirrored") {
    // Beside something of that kind in both, within the ball: where kinds of rays see different shapes, lights are
    // picked in another way.
    const std::string within = "shape core sphere { center 0.7 0.5 0; radius 0.1; visible-to camera }\n";
    const TestScene bare = hiddenStage(within), with = hiddenStage(within + cardSeenBy("camera"));
    CHECK(differingPixels(bare, with, {0, 14, 32, 24}) == 0); // the floor before it
    CHECK(differingPixels(bare, with, kWholePicture) > 20);   // itself
}

TEST_CASE("a card that only shadow rays see is a shadow without a card") {
    // Where the camera looks at the card, it sees what lies behind.
    const TestScene bare = hiddenStage(""), with = hiddenStage(cardSeenBy("shadows")),
                    solid = hiddenStage(cardSeenBy(""));
    const TestImage a = render(bare, 64), b = render(with, 64);
    const auto tile = [](const TestImage& image, PixelBounds part) { return image.film.tile(part, Channel::y).mean; };
    const PixelBounds shade{4, 17, 14, 21};
    CHECK(tile(b, shade) < 0.8 * tile(a, shade));
    CHECK(differingPixels(with, solid, {4, 3, 18, 8}) > 5); // where the card itself would be
}

} // namespace abbe::test
